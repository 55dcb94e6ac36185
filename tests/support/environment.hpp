// SPDX-License-Identifier: Apache-2.0
// How many cases a test goes through: as many as an environment variable says, or few (CONTRIBUTING.md).
#pragma once

#include <algorithm>
#include <cstdlib>

namespace truebearing::testing {

inline int number_from_environment(const char* name, int otherwise) {
  const char* const given = std::getenv(name);
  return given ? std::max(1, std::atoi(given)) : otherwise;
}

}  // namespace truebearing::testing
