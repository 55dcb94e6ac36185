// SPDX-License-Identifier: Apache-2.0
// A target seen in bearings from an own ship that turns: the small cast of the tests of bearings-only trackers.
#pragma once

#include <cmath>
#include <vector>

#include "truebearing/core/angle.hpp"
#include "truebearing/core/random.hpp"
#include "truebearing/measurement/measurement.hpp"
#include "truebearing/simulation/bearings_only_scenario.hpp"

namespace truebearing::testing {

/// Own ship at 5 m/s turns by 90 degrees half-way; the target begins at 5 to 10 km. 8 s, 1 degree; a guess of the
/// range.
inline BearingsOnlyScenario bearings_family(int steps) {
  BearingsOnlyParameters parameters;
  parameters.period_s = 8.0;
  parameters.duration_s = 8.0 * (steps - 1);
  parameters.own_ship.speed_mps = 5.0;
  parameters.own_ship.course_deg = 40.0;
  parameters.own_ship.turns = {{.time_s = parameters.duration_s / 2.0, .angle_deg = 90.0}};
  parameters.target.speed_mps = 4.0;
  parameters.target.course_deg = Distribution(Distribution::Kind::uniform, {0.0, 360.0});
  parameters.range_m = Distribution(Distribution::Kind::uniform, {5e3, 10e3});
  parameters.bearing_deg = Distribution(Distribution::Kind::uniform, {0.0, 360.0});
  parameters.sensor.sigma_rad = radians(1.0);
  parameters.guess = BearingsOnlyParameters::Guess{.range_sigma_m = 2000.0, .least_range_m = 1000.0};
  parameters.accept.closest_m = 1000.0;
  return BearingsOnlyScenario(parameters);
}

inline Recording bearings_run(std::uint64_t run, int steps = 100) {
  return bearings_family(steps).simulate({.seed = 7, .role = Role::evaluation, .run = run});
}

}  // namespace truebearing::testing
