// SPDX-License-Identifier: Apache-2.0
#include "app/data_folder.hpp"

#include <optional>
#include <system_error>

#include "truebearing/core/error.hpp"

namespace truebearing {
namespace {

std::optional<std::filesystem::path> find_data_folder() {
  std::error_code failure;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", failure);
  for (const std::filesystem::path& folder : {program.parent_path().parent_path(), program.parent_path()})
    if (std::filesystem::is_directory(folder / "share/truebearing/data", failure)) return folder / "share/truebearing";
  return std::nullopt;
}

// The file of that name, else the one in a folder of the data that came with the program, else the one that is not
// there.
std::string named_or_shipped(const std::string& name, const std::string& folder) {
  std::error_code failure;
  if (std::filesystem::path(name).has_parent_path() || std::filesystem::exists(name, failure)) return name;
  const std::optional<std::filesystem::path> shared = find_data_folder();
  if (!shared) return name;
  for (const char* extension : {"", ".toml"}) {
    const std::filesystem::path shipped = *shared / "data" / folder / (name + extension);
    if (std::filesystem::is_regular_file(shipped, failure)) return shipped.string();
  }
  return name;
}

}  // namespace

std::filesystem::path data_folder() {
  const std::optional<std::filesystem::path> folder = find_data_folder();
  if (!folder)
    throw InputError("share/truebearing", "stands neither above the program's folder nor beside the program");
  return *folder;
}

std::string study_file(const std::string& name) {
  return named_or_shipped(name, "studies");
}

void add_study(const Subcommand& command, std::string& file) {
  command.argument("study", file, "study file (TOML), or the name of one that comes with the program")
      .required()
      .read_as(study_file);
}

void add_scenario(const Subcommand& command, std::string& file) {
  command.argument("scenario", file, "scenario file (TOML), or the name of one that comes with the program")
      .required()
      .read_as([](const std::string& name) { return named_or_shipped(name, "scenarios"); });
}

}  // namespace truebearing
