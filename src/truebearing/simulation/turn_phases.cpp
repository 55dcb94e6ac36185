// SPDX-License-Identifier: Apache-2.0
#include "truebearing/simulation/turn_phases.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <functional>

#include "truebearing/core/angle.hpp"

namespace truebearing {

std::vector<std::string> TurnPhases::names() const {
  std::vector<std::string> names{"before", "turn"};
  for (const double end_s : after_s) names.push_back(fmt::format("after_{:g}", end_s));
  names.insert(names.end(), {"later", "quiet"});
  if (!std::isfinite(sharp_rad)) return names;
  names.push_back("sharp_turn");
  for (const double end_s : after_s) names.push_back(fmt::format("sharp_after_{:g}", end_s));
  return names;
}

int TurnPhases::at(double time_s, const std::optional<VesselPath::Turn>& turn) const {
  constexpr double kRounding_s = 1e-9;
  const double t = time_s - kRounding_s;
  const int intervals = static_cast<int>(after_s.size());
  const int later = intervals + 2, quiet = later + 1, sharp_turn = quiet + 1;
  if (time_s + kRounding_s < from_s) return -1;
  if (!turn) return quiet;
  if (t <= turn->begin_s) return 0;
  const bool sharp = std::abs(turn->change_rad) >= sharp_rad;
  if (t <= turn->end_s) return sharp ? sharp_turn : 1;
  const auto interval =
      std::find_if(after_s.begin(), after_s.end(), [&](double end) { return t <= turn->end_s + end; });
  if (interval == after_s.end()) return later;
  return (sharp ? sharp_turn : 1) + 1 + static_cast<int>(interval - after_s.begin());
}

TurnPhases read_turn_phases(TableReader& table) {
  TurnPhases phases;
  phases.after_s = table.numbers("after_s", -1, kPositive);
  if (std::adjacent_find(phases.after_s.begin(), phases.after_s.end(), std::greater_equal<>()) != phases.after_s.end())
    throw table.error("after_s", "does not increase", "times in ascending order, each once");
  phases.from_s = table.number_or("from_s", 0.0, kNonNegative);
  // A turn drawn by just so much, in radians and back, is still sharp.
  constexpr double kRounding = 1e-9;
  if (table.has("sharp_deg")) phases.sharp_rad = radians(table.number("sharp_deg", {0.0, 360.0})) - kRounding;
  return phases;
}

}  // namespace truebearing
