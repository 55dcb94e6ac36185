// SPDX-License-Identifier: Apache-2.0
// What comes with the program: share/truebearing/data with scenarios and studies, share/truebearing/models.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace truebearing {

/// share/truebearing above the running program's folder, as installed, or beside the program, as built; else where the
/// library was configured to be installed. None where it is in none of these.
std::optional<std::filesystem::path> find_data_folder();

/// The file of that name where there is one or the name has a folder; else that of this name, with or without .toml, in
/// the folder `data/FOLDER` of what comes with the program; else the name as it is.
std::string named_or_shipped(const std::string& name, const std::string& folder);

}  // namespace truebearing
