// SPDX-License-Identifier: Apache-2.0
// The model file: a CorrectionModel as JSON, readable and editable by hand. Size, nesting, version, shapes and numbers
// are checked before anything is built from it. save -> load -> save is byte-identical. Files of version 1, which also
// held kappa and the referee, are read too.
#pragma once

#include <filesystem>
#include <string>

#include "truebearing/correction/correction_model.hpp"

namespace truebearing {

/// At most 1 MiB and 64 levels. Throws InputError that names file and key.
CorrectionModel read_model_file(const std::filesystem::path& path);
CorrectionModel parse_model(std::string_view text, const std::string& name);
/// The same with the weights that stand beside such a file; of a network that has none of its own they are not looked
/// at.
CorrectionModel parse_model(std::string_view text, const std::string& weights, const std::string& name);

/// Writes the file and, of a recurrent network, its weights beside it: under a name of their own content, before the
/// model file that names them, so that whoever reads finds the old pair or the new one. The weights that the replaced
/// file named are removed.
void write_model_file(const std::filesystem::path& path, const CorrectionModel& model);
/// Of that file; empty where the network stands in the model file.
std::string weights_name(const CorrectionModel& model);
/// What stands in it.
std::string weights_text(const CorrectionModel& model);

/// The text of the file.
std::string model_text(const CorrectionModel& model);

}  // namespace truebearing
