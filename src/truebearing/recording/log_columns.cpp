// SPDX-License-Identifier: Apache-2.0
#include "truebearing/recording/log_columns.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <fstream>
#include <memory>
#include <sstream>
#include <string_view>
#include <system_error>
#include <utility>

#include "truebearing/core/printable.hpp"
#include "truebearing/core/suggestion.hpp"
#include "truebearing/recording/debrief_replay.hpp"
#include "truebearing/recording/log_units.hpp"

namespace truebearing {
namespace {

// Words for what a log knows under another name.
struct OtherWord {
  std::string_view word;
  std::string_view stem;
};
constexpr std::array kOtherWords{OtherWord{"azimuth", "bearing"}, OtherWord{"brg", "bearing"},
                                 OtherWord{"rng", "range"},       OtherWord{"freq", "frequency"},
                                 OtherWord{"lat", "latitude"},    OtherWord{"lon", "longitude"},
                                 OtherWord{"lng", "longitude"}};

}  // namespace

std::string_view to_string(ColumnRole role) {
  switch (role) {
    case ColumnRole::time:
      return "time";
    case ColumnRole::measured:
      return "measured";
    case ColumnRole::sigma:
      return "standard deviation";
    case ColumnRole::sensor:
      return "own ship";
    case ColumnRole::source:
      return "which sensor measured";
    case ColumnRole::guess:
      return "guess";
    case ColumnRole::truth:
      return "truth";
    case ColumnRole::target:
      return "tells targets apart";
    case ColumnRole::position:
      return "position on the globe";
    case ColumnRole::altitude:
      return "height, to studies in space alone:";
    case ColumnRole::velocity:
      return "reported velocity";
    case ColumnRole::left_out:
      break;
  }
  return "left out";
}

namespace {

// A known name in the unit that the file has: "range_km" of "rng_km", where "range_m" is known.
std::string in_unit_of(const NameAndUnit& name, std::string known) {
  const NameAndUnit meant = apart(known);
  if (!name.unit || !meant.unit || name.unit->dimension != meant.unit->dimension) return known;
  return fmt::format("{}_{}", meant.stem, name.unit->suffix);
}

}  // namespace

std::string meant_name(const CsvReader& csv, std::size_t index, const std::vector<std::string>& known) {
  const std::string& header = csv.header()[index];
  const NameAndUnit name = apart(header);
  std::string_view stem = name.stem;
  for (const OtherWord& other : kOtherWords)
    if (stem == other.word) stem = other.stem;
  if (!name.unit || stem != name.stem)
    for (const std::string& candidate : known)
      if (apart(candidate).stem == stem) return in_unit_of(name, candidate);
  return in_unit_of(name, near_miss(header, known));
}

CsvReader with_names(CsvReader csv, const RecordingOptions& options) {
  std::vector<std::pair<std::string, std::string>> renamed;
  for (const auto& [old_name, new_name] : options.columns) {
    csv.required_column(old_name);
    if (!new_name.empty()) renamed.emplace_back(old_name, new_name);
  }
  if (!renamed.empty()) csv.rename(renamed);
  return csv;
}

CsvReader open_table(const std::filesystem::path& path, const RecordingOptions& options) {
  std::error_code unknown;
  if (!is_debrief_replay(path) || std::filesystem::is_directory(path, unknown))
    return with_names(CsvReader(path), options);
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(path.string(), fmt::format("cannot be opened: {}", std::strerror(errno)));
  auto table = std::make_unique<std::istringstream>(table_of_debrief_replay(file, path.string()));
  return with_names(CsvReader(std::move(table), path.string()), options);
}

std::optional<LogColumn> find_column(const CsvReader& csv, std::string_view stem, Dimension dimension) {
  for (const Unit& unit : known_units()) {
    if (unit.dimension != dimension) continue;
    const int column = csv.column(std::string(stem).append("_").append(unit.suffix));
    if (column < 0) continue;
    const NameAndUnit name = apart(csv.header()[static_cast<std::size_t>(column)]);
    return LogColumn{static_cast<std::size_t>(column), ColumnRole::left_out, name.standard_name(), unit.factor};
  }
  return std::nullopt;
}

bool is_unwanted(const std::string& column, const RecordingOptions& options) {
  return std::any_of(options.columns.begin(), options.columns.end(),
                     [&](const auto& name) { return name.first == column && name.second.empty(); });
}

std::optional<std::size_t> find_target_column(const CsvReader& csv, const RecordingOptions& options) {
  const auto find = [&](const char* name) -> std::optional<std::size_t> {
    const int column = csv.column(name);
    if (column < 0 || is_unwanted(name, options)) return std::nullopt;
    return static_cast<std::size_t>(column);
  };
  std::optional<std::size_t> found;
  for (const char* name : {"vessel", "flight", "track"}) {
    const auto column = find(name);
    if (column && found)
      throw InputError(csv.name(), fmt::format("has the columns {} and {}", csv.header()[*found], name),
                       fmt::format("one column that separates targets: --columns {}= leaves one out", name));
    if (column) found = column;
  }
  for (const char* name : {"mmsi", "icao24", "callsign"})
    if (!found) found = find(name);
  return found;
}

std::string read_target_name(const CsvReader& csv, std::size_t column) {
  double number = 0.0;
  if (!csv.read_number(column, number)) return std::string(csv.word(column));
  if (std::isnan(number)) return {};
  if (number != std::floor(number))
    throw csv.error(column, "is " + as_shown(csv.word(column)), "an integer or a name that tells targets apart");
  return std::string(csv.word(column));
}

std::string left_out_note(const std::vector<std::string>& names) {
  if (names.empty()) return {};
  constexpr std::size_t kMostNames = 8;
  std::string list;
  for (std::size_t i = 0; i < std::min(names.size(), kMostNames); ++i)
    list.append(i == 0 ? "" : ", ").append(printable(shortened(names[i], 30)));
  if (names.size() > kMostNames) list += fmt::format(", and {} more", names.size() - kMostNames);
  return "columns left out: " + list;
}

}  // namespace truebearing
