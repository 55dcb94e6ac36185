// SPDX-License-Identifier: Apache-2.0
// The file of a learned motion: JSON, readable and editable by hand, checked before it is used.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "truebearing/correction/learned_motion.hpp"

namespace truebearing {

/// Throws InputError that names file and key.
MotionResidual read_learned_motion_file(const std::filesystem::path& path);
/// The same of its text; `name` stands for the file in messages.
MotionResidual parse_learned_motion(std::string_view text, const std::string& name);
std::string learned_motion_text(const MotionResidual& residual);

}  // namespace truebearing
