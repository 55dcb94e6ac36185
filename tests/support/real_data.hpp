// SPDX-License-Identifier: Apache-2.0
// Recorded data for trials. It is not part of the project; a test that needs a file skips where it is absent.
#pragma once

#include <cstdlib>
#include <filesystem>

namespace truebearing::testing {

/// Where the file would be: in $TRUEBEARING_REAL_DATA, else in shared/data/real beside the project.
inline std::filesystem::path real_data(const std::filesystem::path& name) {
  const char* folder = std::getenv("TRUEBEARING_REAL_DATA");
  const std::filesystem::path beside = std::filesystem::path(TRUEBEARING_SOURCE_DIR) / "../shared/data/real";
  return (folder ? std::filesystem::path(folder) : beside) / name;
}

}  // namespace truebearing::testing
