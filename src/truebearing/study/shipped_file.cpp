// SPDX-License-Identifier: Apache-2.0
#include "truebearing/study/shipped_file.hpp"

#include <system_error>

namespace truebearing {

std::optional<std::filesystem::path> find_data_folder() {
  std::error_code failure;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", failure);
  for (const std::filesystem::path& shared :
       {program.parent_path().parent_path() / "share", program.parent_path() / "share",
        std::filesystem::path(TRUEBEARING_DATA_ROOT)})
    if (std::filesystem::is_directory(shared / "truebearing/data", failure)) return shared / "truebearing";
  return std::nullopt;
}

std::string named_or_shipped(const std::string& name, const std::string& folder) {
  std::error_code failure;
  // A folder of that name, of plots say, is no study.
  if (std::filesystem::path(name).has_parent_path() ||
      (std::filesystem::exists(name, failure) && !std::filesystem::is_directory(name, failure)))
    return name;
  const std::optional<std::filesystem::path> shared = find_data_folder();
  if (!shared) return name;
  for (const char* extension : {"", ".toml"}) {
    const std::filesystem::path shipped = *shared / "data" / folder / (name + extension);
    if (std::filesystem::is_regular_file(shipped, failure)) return shipped.string();
  }
  return name;
}

}  // namespace truebearing
