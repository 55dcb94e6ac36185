// A flight in the East-North plane at constant speed: straight legs and turns in alternation, the turn rate rising and
// falling linearly at both ends of a turn (roll-in). Positions follow exact arcs over sub-steps of at most .1 s.
#pragma once

#include <Eigen/Core>

#include "truebearing/core/random.hpp"
#include "truebearing/simulation/distribution.hpp"

namespace truebearing {

struct PlanarFlight {
  Distribution speed_mps = 100.0;      ///< drawn once per flight
  Distribution leg_s = 60.0;           ///< drawn for each leg; the flight begins at a random point of its first
  Distribution turn_s = 60.0;          ///< drawn for each turn, roll-in included
  Distribution turn_rate_degps = 3.0;  ///< magnitude, drawn for each turn; the side is random
  Distribution roll_in_s = 3.0;        ///< drawn once per flight

  /// Columns: [east_m, north_m, east_mps, north_mps] at 0, period, ..., (samples - 1) period, from the origin on a
  /// random course.
  Eigen::Matrix4Xd fly(double period_s, int samples, RandomStream& stream) const;
};

}  // namespace truebearing
