// SPDX-License-Identifier: Apache-2.0
#include "truebearing/study/configuration_text.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

namespace truebearing {

std::string configuration_text(const toml::node& node) {
  if (const auto* table = node.as_table()) {
    std::string text;
    for (const auto& [key, value] : *table)  // toml++ keeps the keys of a table sorted
      text += fmt::format("{}{} = {}", text.empty() ? "" : ", ", key.str(), configuration_text(value));
    return "{" + text + "}";
  }
  if (const auto* array = node.as_array()) {
    std::string text;
    for (const toml::node& value : *array) text += (text.empty() ? "" : ", ") + configuration_text(value);
    return "[" + text + "]";
  }
  if (const auto* text = node.as_string()) return fmt::format("\"{}\"", text->get());
  if (const auto* flag = node.as_boolean()) return flag->get() ? "true" : "false";
  if (const auto number = node.value<double>()) return fmt::format("{}", *number);
  return "?";
}

toml::table merged(const toml::table& parent, const toml::table& child) {
  toml::table result = parent;
  for (const auto& [key, value] : child) {
    const auto* below = value.as_table();
    auto* over = result.get_as<toml::table>(key.str());
    if (below && over)
      result.insert_or_assign(key, merged(*over, *below));
    else
      result.insert_or_assign(key, value);
  }
  return result;
}

}  // namespace truebearing
