// SPDX-License-Identifier: Apache-2.0
// Text of files and arguments as messages show it: whatever it holds, one line that leaves a terminal alone.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace truebearing {

/// Control characters, characters that turn the direction of a line, and bytes that are no UTF-8 become `\n`, `\t`, `\x1b`.
std::string printable(std::string_view text);

/// The beginning of a printable text and "...", of at most `most` bytes (at least 3); all of it where it fits.
std::string shortened(std::string_view text, std::size_t most);
/// "..." and the end of it.
std::string shortened_from_front(std::string_view text, std::size_t most);

/// A cell or a name: in quotes, printable, of at most 45 bytes.
std::string as_shown(std::string_view text);

}  // namespace truebearing
