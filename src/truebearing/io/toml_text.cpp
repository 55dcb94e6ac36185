// SPDX-License-Identifier: Apache-2.0
// From the text of a TOML file to its table, with a limit on how deep it may nest (declared in table_reader.hpp).
#include <algorithm>
#include <fmt/format.h>
#include <toml++/toml.h>
#include <utility>

#include "truebearing/io/file.hpp"
#include "truebearing/io/table_reader.hpp"

namespace truebearing {
namespace {

constexpr std::size_t kMaxTomlBytes = std::size_t{1} << 20;
constexpr int kMaxDepth = 64;

int depth_of(const toml::node& node) {
  int deepest = 0;
  if (const auto* table = node.as_table())
    for (const auto& [key, value] : *table) deepest = std::max(deepest, depth_of(value));
  if (const auto* array = node.as_array())
    for (const auto& value : *array) deepest = std::max(deepest, depth_of(value));
  return deepest + 1;
}

/// Index of the last character of the string that begins at `begin`, or of the text where it does not end.
std::size_t end_of_string(std::string_view text, std::size_t begin) {
  const char quote = text[begin];
  const std::string thrice(3, quote);
  const bool multi_line = text.substr(begin, 3) == thrice;
  for (std::size_t i = begin + (multi_line ? 3 : 1); i < text.size(); ++i) {
    if (text[i] == '\\' && quote == '"') {
      ++i;
    } else if (!multi_line && (text[i] == quote || text[i] == '\n')) {
      return i;
    } else if (multi_line && text.substr(i, 3) == thrice) {
      // One or two quotes more are the last characters of the string itself: '''x''''.
      const std::size_t past = std::min(text.find_first_not_of(quote, i + 3), i + 5);
      return std::min(past, text.size()) - 1;
    }
  }
  return text.size();
}

/// Open brackets, or dots in one key, whichever are more. Counted before parsing, since a parsed table of any depth is
/// destroyed recursively, and a long enough key of dots would overflow the stack.
int nesting_of_text(std::string_view text) {
  int open = 0, dots = 0, deepest = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    switch (text[i]) {
      case '#':
        i = std::min(text.find('\n', i), text.size()) - 1;
        break;
      case '"':
      case '\'':
        i = end_of_string(text, i);
        break;
      case '[':
      case '{':
        ++open;
        dots = 0;
        break;
      case ']':
      case '}':
        --open;
        dots = 0;
        break;
      case '.':
        ++dots;
        break;
      case '=':
      case ',':
      case '\n':
        dots = 0;
        break;
      default:
        break;
    }
    deepest = std::max({deepest, open, dots});
  }
  return deepest;
}

}  // namespace

SharedTable parse_toml(std::string_view text, const std::string& name) {
  if (text.size() > kMaxTomlBytes)
    throw InputError(name, fmt::format("is {} bytes long", text.size()),
                     fmt::format("at most {} bytes", kMaxTomlBytes));
  const InputError too_deep(name, "is nested too deeply", fmt::format("at most {} levels", kMaxDepth));
  if (nesting_of_text(text) > kMaxDepth) throw too_deep;
  try {
    toml::table table = toml::parse(text, name);
    if (depth_of(table) > kMaxDepth + 1) throw too_deep;
    return std::make_shared<const toml::table>(std::move(table));
  } catch (const toml::parse_error& error) {
    throw InputError(fmt::format("{}:{}", name, error.source().begin.line), std::string(error.description()), "TOML");
  }
}

SharedTable read_toml_file(const std::filesystem::path& path) {
  return parse_toml(read_text_file(path, kMaxTomlBytes), path.string());
}

}  // namespace truebearing
