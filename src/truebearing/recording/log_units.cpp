// SPDX-License-Identifier: Apache-2.0
#include "truebearing/recording/log_units.hpp"

#include <algorithm>
#include <array>

#include "truebearing/core/angle.hpp"

namespace truebearing {
namespace {

constexpr double kDegree_rad = radians(1.0), kFoot_m = 0.3048, kNauticalMile_m = 1852.0, kHour_s = 3600.0;

constexpr std::array kUnits{Unit{"m", Dimension::length, 1.0, "m"},
                            Unit{"meters", Dimension::length, 1.0, "m"},
                            Unit{"metres", Dimension::length, 1.0, "m"},
                            Unit{"km", Dimension::length, 1000.0, "m"},
                            Unit{"nmi", Dimension::length, kNauticalMile_m, "m"},
                            Unit{"nm", Dimension::length, kNauticalMile_m, "m"},
                            Unit{"ft", Dimension::length, kFoot_m, "m"},
                            Unit{"feet", Dimension::length, kFoot_m, "m"},
                            Unit{"yd", Dimension::length, 3.0 * kFoot_m, "m"},
                            Unit{"kyd", Dimension::length, 3000.0 * kFoot_m, "m"},
                            Unit{"mps", Dimension::speed, 1.0, "mps"},
                            Unit{"kn", Dimension::speed, kNauticalMile_m / kHour_s, "mps"},
                            Unit{"kt", Dimension::speed, kNauticalMile_m / kHour_s, "mps"},
                            Unit{"kts", Dimension::speed, kNauticalMile_m / kHour_s, "mps"},
                            Unit{"knots", Dimension::speed, kNauticalMile_m / kHour_s, "mps"},
                            Unit{"kmh", Dimension::speed, 1000.0 / kHour_s, "mps"},
                            Unit{"kmph", Dimension::speed, 1000.0 / kHour_s, "mps"},
                            Unit{"mph", Dimension::speed, 5280.0 * kFoot_m / kHour_s, "mps"},
                            Unit{"fps", Dimension::speed, kFoot_m, "mps"},
                            Unit{"mps2", Dimension::acceleration, 1.0, "mps2"},
                            Unit{"rad", Dimension::angle, 1.0, "rad"},
                            Unit{"radians", Dimension::angle, 1.0, "rad"},
                            Unit{"mrad", Dimension::angle, 1e-3, "rad"},
                            Unit{"deg", Dimension::angle, kDegree_rad, "deg"},
                            Unit{"degrees", Dimension::angle, kDegree_rad, "deg"},
                            Unit{"radps", Dimension::angular_rate, 1.0, "radps"},
                            Unit{"degps", Dimension::angular_rate, kDegree_rad, "degps"},
                            Unit{"hz", Dimension::frequency, 1.0, "hz"},
                            Unit{"khz", Dimension::frequency, 1e3, "hz"},
                            Unit{"s", Dimension::time, 1.0, "s"},
                            Unit{"seconds", Dimension::time, 1.0, "s"},
                            Unit{"ms", Dimension::time, 1e-3, "s"},
                            Unit{"us", Dimension::time, 1e-6, "s"},
                            Unit{"ns", Dimension::time, 1e-9, "s"},
                            Unit{"min", Dimension::time, 60.0, "s"},
                            Unit{"h", Dimension::time, kHour_s, "s"}};

}  // namespace

std::span<const Unit> known_units() {
  return kUnits;
}

std::string NameAndUnit::standard_name() const {
  return std::string(stem).append("_").append(unit->stands);
}

NameAndUnit apart(std::string_view column) {
  const std::size_t split = column.rfind('_');
  if (split == column.npos || split == 0) return {column};
  const auto unit = std::find_if(kUnits.begin(), kUnits.end(),
                                 [&](const Unit& one) { return one.suffix == column.substr(split + 1); });
  if (unit == kUnits.end()) return {column};
  return {column.substr(0, split), &*unit};
}

std::string suffixes_of(Dimension dimension) {
  std::string list;
  for (const Unit& unit : kUnits)
    if (unit.dimension == dimension) list.append(list.empty() ? "_" : ", _").append(unit.suffix);
  return list;
}

std::string all_suffixes() {
  std::string list;
  for (const Unit& unit : kUnits)
    if (unit.suffix == unit.stands && unit.dimension != Dimension::time)
      list.append(list.empty() ? "_" : ", _").append(unit.suffix);
  return list;
}

}  // namespace truebearing
