// SPDX-License-Identifier: Apache-2.0
#include "truebearing/study/angle_bound_scoring.hpp"

#include "truebearing/core/angle.hpp"

namespace truebearing {
std::optional<AngleBound> read_angle_bound(TableReader& scoring, const StateSpace& truth) {
  std::optional<TableReader> table = scoring.table_if_present("angle_bound");
  if (!table) return std::nullopt;
  if (truth != angle_space())
    throw scoring.error("angle_bound", "is of angles at a line array, and the scenario's truth is " + truth.name);
  AngleBound bound;
  bound.q_rad2ps3 = table->number_or("q_deg2ps3", 0.03, kPositive) * radians(1.0) * radians(1.0);
  bound.rate_sigma_radps = radians(table->number_or("rate_sigma_degps", 2.0, kPositive));
  bound.apart_rad = radians(table->number_or("apart_deg", 10.0, kNonNegative));
  table->finish();
  return bound;
}

}  // namespace truebearing
