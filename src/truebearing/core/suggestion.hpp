// SPDX-License-Identifier: Apache-2.0
// "Did you mean": the nearest valid name to a misspelt one.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace truebearing {

/// The nearest of `valid` by edit distance, or an empty string where none is near.
std::string nearest_name(std::string_view name, const std::vector<std::string>& valid);

/// The one of `valid` that is probably meant: the same but for the case of letters, what joins words, or few letters in
/// proportion to their number; an empty string where there is none.
std::string near_miss(std::string_view name, const std::vector<std::string>& valid);

/// One line for an error: `"velocity_mps" (did you mean it?), of a, b, velocity_mps`. At most twelve names are listed.
std::string suggestion(std::string_view name, const std::vector<std::string>& valid);

}  // namespace truebearing
