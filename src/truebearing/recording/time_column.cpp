// SPDX-License-Identifier: Apache-2.0
#include "truebearing/recording/time_column.hpp"

#include <array>
#include <cmath>
#include <fmt/format.h>
#include <string>

#include "truebearing/core/printable.hpp"
#include "truebearing/io/iso_time.hpp"
#include "truebearing/recording/log_units.hpp"

namespace truebearing {
namespace {

constexpr std::array<std::string_view, 2> kStems{"time", "timestamp"};
constexpr std::array<std::string_view, 6> kTextNames{"time",     "timestamp", "datetime",
                                                     "time_utc", "time_iso",  "timestamp_utc"};

// A name with a unit goes before one without, time_s before all.
std::size_t find_time(const CsvReader& csv) {
  for (const std::string_view stem : kStems)
    for (const Unit& unit : known_units()) {
      if (unit.dimension != Dimension::time) continue;
      const int column = csv.column(std::string(stem).append("_").append(unit.suffix));
      if (column >= 0) return static_cast<std::size_t>(column);
    }
  for (const std::string_view name : kTextNames)
    if (const int column = csv.column(name); column >= 0) return static_cast<std::size_t>(column);
  return csv.required_column("time_s");
}

}  // namespace

TimeColumn::TimeColumn(const CsvReader& csv) : index_(find_time(csv)) {
  const NameAndUnit name = apart(csv.header()[index_]);
  if (name.unit && name.unit->dimension == Dimension::time) unit_s_ = name.unit->factor;
}

double TimeColumn::read(const CsvReader& csv) {
  double time_s = 0.0;
  const bool is_number = csv.read_number(index_, time_s);
  if (is_number && std::isnan(time_s)) throw csv.error(index_, "is missing or infinite", "a finite time");
  if (is_number && !unit_s_)
    throw csv.error(index_, fmt::format("is {}, a number without a unit", time_s),
                    fmt::format("an ISO 8601 time, or --columns {}=time_s", csv.header()[index_]));
  // Divided where the unit is a whole part of a second: 0.001 is no number of the computer.
  if (is_number) time_s = *unit_s_ < 1.0 ? time_s / std::round(1.0 / *unit_s_) : time_s * *unit_s_;
  if (!is_number) {
    const auto seconds = seconds_of_iso_time(csv.word(index_));
    if (!seconds)
      throw csv.error(index_, "is " + as_shown(csv.word(index_)),
                      "a number, or an ISO 8601 time: 2026-01-31T12:00:00Z");
    time_s = *seconds;
  }
  if (is_text_ && *is_text_ == is_number)
    throw csv.error(index_, is_number ? "is a number, after texts" : "is text, after numbers", "one or the other");
  is_text_ = !is_number;
  return time_s;
}

}  // namespace truebearing
