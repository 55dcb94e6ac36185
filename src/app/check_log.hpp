// SPDX-License-Identifier: Apache-2.0
// truebearing check LOG: what a recorded log or a step log holds, and whether it can be used.
#pragma once

#include <string>

#include "app/log_options.hpp"

namespace truebearing {

/// Prints what a line array's log (HDF5) holds. Throws InputError where it cannot be read.
void check_snapshot_log(const std::string& path);

/// Prints what a step log holds. Throws InputError where it cannot be read.
void check_step_log(const std::string& path);

/// Prints the report, or writes it as JSON where `json` is not empty ("-" is standard output). Throws InputError where
/// the log cannot be used.
void check_log_file(const std::string& path, const LogArguments& reading, const std::string& json);

}  // namespace truebearing
