// SPDX-License-Identifier: Apache-2.0
#include "truebearing/study/parameters_file.hpp"

#include <cmath>
#include <fmt/format.h>
#include <string_view>
#include <toml++/toml.h>

#include "truebearing/core/error.hpp"
#include "truebearing/io/key_survey.hpp"
#include "truebearing/io/table_reader.hpp"

namespace truebearing {
namespace {

// A basic string of TOML.
std::string toml_text(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
      result += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
    else
      result += c;
  }
  return result + "\"";
}

std::string toml_key(std::string_view name) {
  const bool bare =
      !name.empty() && name.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-") ==
                           std::string_view::npos;
  return bare ? std::string(name) : toml_text(name);
}

void put_numbers(toml::table& table, const std::string& path, const std::vector<double>& values) {
  // An element of an array, or a table inside one, exists: tuned numbers replace numbers. Anything else is made.
  if (path.find('[') != std::string::npos) {
    if (auto node = table.at_path(path)) {
      if (auto* array = node.as_array()) {
        array->clear();
        for (const double value : values) array->push_back(value);
        return;
      }
      const std::size_t dot = path.rfind('.');
      if (dot != std::string::npos)
        if (auto* parent = table.at_path(path.substr(0, dot)).as_table()) {
          parent->insert_or_assign(path.substr(dot + 1), values.front());
          return;
        }
    }
    throw InputError(path, "is no number of the tracker");
  }
  toml::table* parent = &table;
  std::size_t begin = 0;
  for (std::size_t dot = path.find('.'); dot != std::string::npos; dot = path.find('.', begin)) {
    auto* next = parent->get_as<toml::table>(path.substr(begin, dot - begin));
    if (!next) next = parent->insert_or_assign(path.substr(begin, dot - begin), toml::table{}).first->second.as_table();
    parent = next;
    begin = dot + 1;
  }
  const std::string last = path.substr(begin);
  const toml::node* old = parent->get(last);
  if (values.size() == 1 && !(old && old->is_array())) {
    parent->insert_or_assign(last, values.front());
    return;
  }
  toml::array array;
  for (const double value : values) array.push_back(value);
  parent->insert_or_assign(last, std::move(array));
}

ParametersFile parameters_from(const SharedTable& table, const std::string& name_of_file) {
  ParametersFile parameters;
  const KeySurvey apart;  // what a command wrote is no part of a study's keys
  TableReader reader(table, name_of_file);
  for (const std::string& name : reader.keys()) {
    TableReader tracker = reader.table(name);
    for (const std::string& parameter : tracker.keys()) {
      if (name == "provenance")
        parameters.provenance.emplace_back(parameter, tracker.text(parameter));
      else
        parameters.trackers[name][parameter] =
            tracker.numbers(parameter, -1, parameter == kMeasurementMatrix ? kAnyNumber : kPositive);
    }
  }
  return parameters;
}

}  // namespace

ParametersFile read_parameters_file(const std::filesystem::path& path) {
  return parameters_from(read_toml_file(path), path.string());
}

ParametersFile parse_parameters(std::string_view text, const std::string& name) {
  return parameters_from(parse_toml(text, name), name);
}

std::string parameters_text(const ParametersFile& parameters) {
  std::string text =
      "# Baseline parameters, written by `truebearing tune`. Studies name this file under `parameters`.\n";
  text += "\n[provenance]\n";
  for (const auto& [name, value] : parameters.provenance)
    text += fmt::format("{} = {}\n", toml_key(name), toml_text(value));
  for (const auto& [name, values] : parameters.trackers) {
    text += fmt::format("\n[{}]\n", toml_key(name));
    for (const auto& [path, numbers] : values) {
      std::string list;
      for (const double value : numbers) list += fmt::format("{}{:.6g}", list.empty() ? "" : ", ", value);
      text += numbers.size() == 1 ? fmt::format("{} = {}\n", toml_text(path), list)
                                  : fmt::format("{} = [{}]\n", toml_text(path), list);
    }
  }
  return text;
}

std::vector<double> numbers_at(const toml::table& table, const std::string& path, const std::string& where) {
  const auto node = table.at_path(path);
  std::vector<double> values;
  if (const auto* array = node.as_array()) {
    for (const toml::node& element : *array) values.push_back(element.value<double>().value_or(0.0));
  } else if (const auto value = node.value<double>()) {
    values.push_back(*value);
  }
  if (values.empty()) throw InputError(where, "\"" + path + "\" is no number or array of numbers of the tracker");
  for (const double value : values)
    if (path == kMeasurementMatrix ? !std::isfinite(value) : !(value > 0.0))
      throw InputError(where, fmt::format("\"{}\" holds {}", path, value), "numbers > 0 as a start for tuning");
  return values;
}

SharedTable with_numbers(const toml::table& table, const std::string& path, const std::vector<double>& values) {
  toml::table result = table;
  put_numbers(result, path, values);
  return std::make_shared<const toml::table>(std::move(result));
}

}  // namespace truebearing
