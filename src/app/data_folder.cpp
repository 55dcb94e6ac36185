// SPDX-License-Identifier: Apache-2.0
#include "app/data_folder.hpp"

#include <optional>

#include "truebearing/core/error.hpp"
#include "truebearing/study/shipped_file.hpp"

namespace truebearing {
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
