// SPDX-License-Identifier: Apache-2.0
#include "truebearing/io/json_lines.hpp"

#include <algorithm>
#include <cstddef>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <vector>

#include "truebearing/core/error.hpp"
#include "truebearing/core/printable.hpp"
#include "truebearing/io/csv.hpp"

namespace truebearing {
namespace {

constexpr std::size_t kMostKeys = 1000, kMostBytes = std::size_t{1} << 20;  // of a line
constexpr const char* kValid = R"(an object of numbers and texts, {"time_s": 1.0, "range_m": 5000})";

// A cell's text: numbers as they stand, null as nothing.
std::string cell_of(const nlohmann::ordered_json& value, const InputError& error) {
  if (value.is_null()) return {};
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number() || value.is_boolean()) return value.dump();
  throw error;
}

}  // namespace

bool is_json_lines(const std::filesystem::path& path) {
  return path.extension() == ".jsonl" || path.extension() == ".ndjson";
}

std::string csv_of_json_lines(std::istream& stream, const std::string& name) {
  std::vector<std::string> keys;
  std::vector<std::vector<std::string>> rows;  // of a blank line none
  std::string line;
  for (std::size_t number = 1; std::getline(stream, line); ++number) {
    const std::string where = fmt::format("{}:{}", name, number);
    std::vector<std::string>& row = rows.emplace_back();
    if (line.find_first_not_of(" \t\r") == line.npos) continue;
    if (line.size() > kMostBytes) throw InputError(where, "is too long a line", fmt::format("{} bytes", kMostBytes));
    const auto object = nlohmann::ordered_json::parse(line, nullptr, false);
    if (!object.is_object()) throw InputError(where, "is " + as_shown(line), kValid);
    for (const auto& [key, value] : object.items()) {
      const auto known = std::find(keys.begin(), keys.end(), key);
      const auto place = static_cast<std::size_t>(known - keys.begin());
      if (known == keys.end()) keys.push_back(key);
      if (keys.size() > kMostKeys) throw InputError(where, "has too many keys", fmt::format("at most {}", kMostKeys));
      if (row.size() <= place) row.resize(place + 1);
      row[place] =
          cell_of(value, InputError(where + ": " + shortened(printable(key), 40), "is no number or text", kValid));
    }
  }
  if (keys.empty()) throw InputError(name, "has no lines", kValid);
  CsvWriter csv(keys);
  std::string text = csv.take();
  for (std::vector<std::string>& row : rows) {
    if (row.empty()) {
      text += '\n';
      continue;
    }
    row.resize(keys.size());
    for (const std::string& cell : row) csv.text(cell);
    csv.end_row();
    text += csv.take();
  }
  return text;
}

}  // namespace truebearing
