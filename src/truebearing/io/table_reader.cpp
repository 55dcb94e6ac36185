// SPDX-License-Identifier: Apache-2.0
#include "truebearing/io/table_reader.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <toml++/toml.h>
#include <utility>

#include "truebearing/core/suggestion.hpp"
#include "truebearing/io/key_survey.hpp"

namespace truebearing {
namespace {

// What is valid where a key holds no number.
constexpr const char *kBoolean = "true or false", *kText = "text in quotes", *kTexts = "an array of texts",
                     *kTable = "a table", *kTables = "an array of tables";

std::string type_name(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::string:
      return "text";
    case toml::node_type::integer:
      return "an integer";
    case toml::node_type::floating_point:
      return "a number";
    case toml::node_type::boolean:
      return "true or false";
    case toml::node_type::array:
      return "an array";
    case toml::node_type::table:
      return "a table";
    default:
      return "a date or time";
  }
}

/// For a survey of keys: what is read, which values are valid.
void note(const TableReader& reader, const std::string& key, const char* type, const std::string& valid = {}) {
  SurveyedKey* entry = surveyed(reader, key);
  if (!entry) return;
  if (entry->type.empty()) entry->type = type;
  if (!valid.empty()) entry->valid.insert(valid);
}

void note_choice(const TableReader& reader, const std::string& key, const std::vector<std::string>& choices) {
  note(reader, key, "text", fmt::format("\"{}\"", fmt::join(choices, "\", \"")));
  if (SurveyedKey* entry = surveyed(reader, key)) entry->choices.insert(choices.begin(), choices.end());
}

/// And what it is where it is not said.
void note_default(const TableReader& reader, const std::string& key, const std::string& value) {
  if (SurveyedKey* entry = surveyed(reader, key)) entry->defaults.insert(value);
}

std::string integer_in(std::int64_t low, std::int64_t high) {
  return fmt::format("an integer in [{}, {}]", low, high);
}

// Of the key, or of the table where it has none; 0 where neither is of a file.
std::uint32_t line_of(const toml::table& table, const std::string& key) {
  const toml::node* node = table.get(key);
  return (node ? *node : table).source().begin.line;
}

bool contains(Range range, double value) {
  return std::isfinite(value) && (range.open_low ? value > range.low : value >= range.low) && value <= range.high;
}

}  // namespace

std::string describe(Range range) {
  if (range.high >= 1e300) {
    if (range.low <= -1e300) return "a finite number";
    return fmt::format("a number {} {}", range.open_low ? ">" : ">=", range.low);
  }
  return fmt::format("a number in {}{}, {}]", range.open_low ? "(" : "[", range.low, range.high);
}

TableReader::TableReader(SharedTable table, std::string file, std::string path, SharedTable own)
    : table_(std::move(table)), own_(std::move(own)), file_(std::move(file)), path_(std::move(path)) {}

std::string TableReader::where(const std::string& key) const {
  auto line = line_of(*table_, key);
  if (line == 0 && own_) line = line_of(*own_, key);  // toml++ copies no lines, and a table over another is a copy
  const std::string name = path_.empty() || key.empty() ? path_ + key : path_ + "." + key;
  std::string place = line > 0 ? fmt::format("{}:{}", file_, line) : file_;
  return name.empty() ? place : place + ": " + name;
}

InputError TableReader::error(const std::string& key, const std::string& found, const std::string& valid) const {
  return {where(key), found, valid};
}

const toml::node* TableReader::node(const std::string& key) {
  surveyed(*this, key);
  asked_.insert(key);
  return table_->get(key);
}

bool TableReader::has(const std::string& key) {
  if (SurveyedKey* entry = surveyed(*this, key)) entry->optional = true;
  return node(key) != nullptr;
}

const toml::node& TableReader::required(const std::string& key, const std::string& valid) {
  const toml::node* found = node(key);
  if (found) return *found;
  throw error(key, "is missing", valid + mistyped({key}));
}

std::string TableReader::one_of(const std::string& a, const std::string& b) {
  const bool has_a = has(a), has_b = has(b);
  if (has_a == has_b)
    throw error("", has_a ? fmt::format("has both {} and {}", a, b) : fmt::format("has neither {} nor {}", a, b),
                "one of the two" + (has_a ? std::string() : mistyped({a, b})));
  return has_a ? a : b;
}

// A key that nobody has asked for yet and that may stand for one of these, as a hint; or nothing.
std::string TableReader::mistyped(const std::vector<std::string>& wanted) const {
  for (const std::string& other : keys())
    if (!asked_.contains(other) && !near_miss(other, wanted).empty())
      return fmt::format(" (did you mean it by \"{}\"?)", other);
  return {};
}

double TableReader::number(const std::string& key, Range range) {
  note(*this, key, "number", describe(range));
  const toml::node& found = required(key, describe(range));
  const auto value = found.value<double>();
  if (!value || found.is_boolean()) throw error(key, "is " + type_name(found), describe(range));
  if (!contains(range, *value)) throw error(key, fmt::format("is {}", *value), describe(range));
  return *value;
}

double TableReader::number_or(const std::string& key, double fallback, Range range) {
  note(*this, key, "number", describe(range));
  note_default(*this, key, fmt::format("{}", fallback));
  return has(key) ? number(key, range) : fallback;
}

std::int64_t TableReader::integer(const std::string& key, std::int64_t low, std::int64_t high) {
  const std::string valid = integer_in(low, high);
  note(*this, key, "integer", valid);
  const toml::node& found = required(key, valid);
  const auto* value = found.as_integer();
  if (!value) throw error(key, "is " + type_name(found), valid);
  if (value->get() < low || value->get() > high) throw error(key, fmt::format("is {}", value->get()), valid);
  return value->get();
}

std::int64_t TableReader::integer_or(const std::string& key, std::int64_t fallback, std::int64_t low,
                                     std::int64_t high) {
  note(*this, key, "integer", integer_in(low, high));
  note_default(*this, key, fmt::format("{}", fallback));
  return has(key) ? integer(key, low, high) : fallback;
}

bool TableReader::boolean_or(const std::string& key, bool fallback) {
  note(*this, key, "true or false");
  note_default(*this, key, fallback ? "true" : "false");
  if (!has(key)) return fallback;
  const toml::node& found = required(key, kBoolean);
  const auto* value = found.as_boolean();
  if (!value) throw error(key, "is " + type_name(found), kBoolean);
  return value->get();
}

std::string TableReader::text(const std::string& key) {
  note(*this, key, "text");
  const toml::node& found = required(key, kText);
  const auto* value = found.as_string();
  if (!value) throw error(key, "is " + type_name(found), kText);
  return value->get();
}

std::string TableReader::text_or(const std::string& key, std::string fallback) {
  note(*this, key, "text");
  if (!fallback.empty()) note_default(*this, key, '"' + fallback + '"');
  return has(key) ? text(key) : std::move(fallback);
}

std::string TableReader::choice(const std::string& key, const std::vector<std::string>& valid) {
  note_choice(*this, key, valid);
  static_cast<void>(required(key, fmt::format("one of \"{}\"", fmt::join(valid, "\", \""))));
  std::string value = text(key);
  if (std::find(valid.begin(), valid.end(), value) == valid.end())
    throw error(key, "is \"" + value + "\"", suggestion(value, valid));
  return value;
}

std::string TableReader::choice_or(const std::string& key, const std::vector<std::string>& valid,
                                   std::string fallback) {
  note_choice(*this, key, valid);
  note_default(*this, key, '"' + fallback + '"');
  return has(key) ? choice(key, valid) : std::move(fallback);
}

std::vector<double> TableReader::numbers(const std::string& key, int size, Range range) {
  const std::string count = size < 0 ? "an array, each " : fmt::format("{} numbers, each ", size);
  note(*this, key, "numbers", count + describe(range));
  const toml::node& found = required(key, count + describe(range));
  std::vector<double> values;
  const auto take = [&](const toml::node& element) {
    const auto value = element.value<double>();
    if (!value || element.is_boolean()) throw error(key, "holds " + type_name(element), count + describe(range));
    if (!contains(range, *value)) throw error(key, fmt::format("holds {}", *value), count + describe(range));
    values.push_back(*value);
  };
  if (const auto* array = found.as_array())
    for (const toml::node& element : *array) take(element);
  else
    take(found);
  if (size >= 0 && values.size() != static_cast<std::size_t>(size))
    throw error(key, fmt::format("holds {} numbers", values.size()), count + describe(range));
  return values;
}

std::vector<std::string> TableReader::texts(const std::string& key) {
  note(*this, key, "texts");
  const toml::node& found = required(key, kTexts);
  const auto* array = found.as_array();
  if (!array) throw error(key, "is " + type_name(found), kTexts);
  std::vector<std::string> values;
  for (const toml::node& element : *array) {
    const auto* value = element.as_string();
    if (!value) throw error(key, "holds " + type_name(element), kTexts);
    values.push_back(value->get());
  }
  return values;
}

TableReader TableReader::inside(const std::string& key, const toml::table& table, std::string path,
                                std::size_t index) const {
  return {SharedTable(table_, &table), file_, std::move(path), own_inside(key, index)};
}

SharedTable TableReader::own_inside(const std::string& key, std::size_t index) const {
  static const auto kNothing = std::make_shared<const toml::table>();
  if (!own_) return nullptr;
  const toml::node* own = own_->get(key);
  if (own && own->is_array()) own = own->as_array()->get(index);  // which is one's own as a whole
  return own && own->is_table() ? SharedTable(own_, own->as_table()) : kNothing;
}

TableReader TableReader::table(const std::string& key) {
  note(*this, key, "table");
  const toml::node& found = required(key, kTable);
  const auto* sub = found.as_table();
  if (!sub) throw error(key, "is " + type_name(found), kTable);
  return inside(key, *sub, path_.empty() ? key : path_ + "." + key);
}

std::optional<TableReader> TableReader::table_if_present(const std::string& key) {
  note(*this, key, "table");
  if (!has(key)) return std::nullopt;
  return table(key);
}

std::vector<TableReader> TableReader::tables(const std::string& key) {
  note(*this, key, "tables");
  std::vector<TableReader> readers;
  if (!has(key)) return readers;
  const toml::node& found = required(key, kTables);
  const auto* array = found.as_array();
  if (!array) throw error(key, "is " + type_name(found), kTables);
  std::size_t index = 0;
  for (const toml::node& element : *array) {
    const auto* sub = element.as_table();
    if (!sub) throw error(key, "holds " + type_name(element), kTables);
    readers.push_back(inside(key, *sub, fmt::format("{}{}{}[{}]", path_, path_.empty() ? "" : ".", key, index), index));
    ++index;
  }
  return readers;
}

std::vector<std::string> TableReader::keys() const {
  std::vector<std::pair<std::uint32_t, std::string>> placed;
  for (const auto& [key, value] : *table_) placed.emplace_back(value.source().begin.line, std::string(key.str()));
  std::stable_sort(placed.begin(), placed.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<std::string> names;
  for (auto& [line, name] : placed) names.push_back(std::move(name));
  return names;
}

void TableReader::finish() const {
  for (const std::string& key : keys())
    if (!asked_.contains(key) && (!own_ || own_->contains(key)))
      throw error(key, "is not a known key", suggestion(key, {asked_.begin(), asked_.end()}));
}

std::filesystem::path TableReader::resolve(const std::string& relative) const {
  const std::filesystem::path path(relative);
  return path.is_absolute() ? path : std::filesystem::path(file_).parent_path() / path;
}

}  // namespace truebearing
