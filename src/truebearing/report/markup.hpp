// SPDX-License-Identifier: Apache-2.0
// Text of files and people inside HTML and SVG: whatever it holds, it stays text.
#pragma once

#include <string>
#include <string_view>

namespace truebearing {

/// Between tags or inside a quoted attribute. Control characters, and bytes that are no UTF-8, become `\n`, `\x1b`.
std::string escaped(std::string_view text);

/// With its first letter, of a to z, as a capital.
std::string capitalised(std::string text);

/// A figure as pages show it, of `digits` digits: "0.0123", "1338", with narrow spaces between thousands from 10 000
/// on; "-" where it is not known.
std::string shown(double value, int digits = 4);

}  // namespace truebearing
