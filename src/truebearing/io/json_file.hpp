// SPDX-License-Identifier: Apache-2.0
// JSON files with limits: size and nesting are checked before anything of that size or depth is built, and a key that
// stands twice in one object is refused. What is written ends with a newline; NaN and infinities become null.
#pragma once

#include <cstddef>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace truebearing {

struct JsonLimits {
  std::size_t max_bytes = std::size_t{1} << 20;
  std::size_t max_depth = 64;
};

/// Throws InputError with file and line.
nlohmann::json read_json_file(const std::filesystem::path& path, JsonLimits limits = {});
/// The same for text; `name` stands for the file in messages.
nlohmann::json parse_json(std::string_view text, const std::string& name, JsonLimits limits = {});
/// The same, its keys in the order of the text.
nlohmann::ordered_json parse_ordered_json(std::string_view text, const std::string& name, JsonLimits limits = {});

/// The text of a file: indented by two, in the order in which the keys were added.
std::string json_text(const nlohmann::ordered_json& value);

}  // namespace truebearing
