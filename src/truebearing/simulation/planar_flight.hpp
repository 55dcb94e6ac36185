// SPDX-License-Identifier: Apache-2.0
// A flight in the East-North plane: straight legs and manoeuvres in alternation. A manoeuvre is a turn at constant
// speed or an acceleration along the track; its rate rises and falls linearly at both ends (roll-in). Positions follow
// exact arcs over sub-steps of at most .1 s. With `intervals` it is a flight of these instead (flight_intervals.hpp).
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "truebearing/core/constants.hpp"
#include "truebearing/core/random.hpp"
#include "truebearing/simulation/distribution.hpp"
#include "truebearing/simulation/flight_intervals.hpp"

namespace truebearing {

/// What a target flew, sample by sample.
struct FlownTrack {
  Eigen::Matrix4Xd states;            ///< columns [east_m, north_m, east_mps, north_mps]
  Eigen::VectorXd since_manoeuvre_s;  ///< time since a manoeuvre was under way: 0 in one, infinity before the first
  double end_s = kInfinity;           ///< of the flight
};

struct PlanarFlight {
  Distribution speed_mps = 100.0;  ///< drawn once per flight; constant but for accelerations
  /// Before the first manoeuvre; where absent, the flight begins at a random point of its first leg.
  std::optional<Distribution> first_leg_s;
  Distribution leg_s = 60.0;           ///< drawn for each leg
  Distribution turn_s = 60.0;          ///< drawn for each turn, roll-in included
  Distribution turn_rate_degps = 3.0;  ///< magnitude, drawn for each turn; the side is random
  Distribution roll_in_s = 3.0;        ///< drawn once per flight

  double acceleration_share = 0.0;       ///< probability that a manoeuvre is an acceleration along the track
  Distribution acceleration_s = 10.0;    ///< drawn for each acceleration
  Distribution acceleration_mps2 = 1.0;  ///< magnitude, drawn for each acceleration; the sign is random
  double lowest_speed_mps = 0.0;         ///< an acceleration ends at these speeds
  double highest_speed_mps = 1e9;
  double quiet_share = 0.0;  ///< probability that a flight has no manoeuvre

  std::optional<FlightIntervals> intervals;  ///< in place of all but the speed, which the first begins with

  /// At times that ascend from 0, from the origin on a random course.
  FlownTrack fly(std::span<const double> times_s, RandomStream& stream) const;

  bool operator==(const PlanarFlight&) const = default;
};

/// Reads the table [flight] of a scenario.
PlanarFlight read_planar_flight(TableReader flight);

}  // namespace truebearing
