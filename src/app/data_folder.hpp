// SPDX-License-Identifier: Apache-2.0
// What comes with the program, as the command line takes it by name (study/shipped_file.hpp).
#pragma once

#include <filesystem>
#include <string>

#include "app/arguments.hpp"

namespace truebearing {

/// find_data_folder(). Throws InputError where there is none.
std::filesystem::path data_folder();

/// The file of that name, or else that of the study of that name, with or without .toml, that comes with the program.
std::string study_file(const std::string& name);

/// The argument "study" or "scenario": a file, or else the name, with or without .toml, of one that comes with the
/// program.
void add_study(const Subcommand& command, std::string& file);
void add_scenario(const Subcommand& command, std::string& file);

}  // namespace truebearing
