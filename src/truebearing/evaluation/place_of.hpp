// SPDX-License-Identifier: Apache-2.0
// Where a component stands among those that are measured.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

namespace truebearing {

/// -1 where there is none of that name.
inline int place_of(const std::vector<std::string>& names, const std::string& name) {
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? -1 : static_cast<int>(found - names.begin());
}

}  // namespace truebearing
