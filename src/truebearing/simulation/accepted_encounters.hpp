// SPDX-License-Identifier: Apache-2.0
// A family of encounters may accept some of its draws only: those whose target never comes too close, and those whose
// range or position the measurements determine in time (its Cramer-Rao bound, as if the target kept its first
// velocity).
#pragma once

#include <optional>

#include "truebearing/core/bounded.hpp"
#include "truebearing/simulation/sonar.hpp"
#include "truebearing/simulation/source.hpp"
#include "truebearing/simulation/vessel.hpp"

namespace truebearing {

/// One draw: how own ship and a target sail, when own ship listens, and what the target radiates.
struct Encounter {
  double period_s;
  int steps;
  VesselPath own_ship;
  VesselPath target;
  std::optional<SourceTone> tone;  ///< nothing where the target is no source

  /// [east, north, v_east, v_north], and the frequency of a source.
  BoundedVector target_at(double time_s) const;
};

struct AcceptedEncounters {
  double closest_m = 0.0;
  std::optional<double> range_bound_percent;  ///< bearings' bound at the end, of the range then
  /// The root mean square of the position's error that the bound allows at a time, from all that is measured until then
  /// of a source that keeps its first frequency.
  struct PositionBound {
    double most_m = 0.0;
    double at_s = 0.0;
  };
  std::optional<PositionBound> position_bound;

  bool accepts(const Encounter& encounter, const Sonar& sensor) const;

 private:
  bool determines_position(const Encounter& encounter, const Sonar& sensor) const;
};

/// The table [accept] of a scenario that lasts duration_s.
AcceptedEncounters read_accepted_encounters(TableReader table, double duration_s);

}  // namespace truebearing
