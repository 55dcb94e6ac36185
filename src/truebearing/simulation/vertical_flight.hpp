// SPDX-License-Identifier: Apache-2.0
// The height of a target that flies level and climbs or descends in alternation. The climb rate goes from one value to
// the next at a constant vertical acceleration; it is that of the end of each sub-step of at most .1 s.
#pragma once

#include <Eigen/Core>
#include <span>

#include "truebearing/core/random.hpp"
#include "truebearing/simulation/distribution.hpp"

namespace truebearing {

struct VerticalFlight {
  Distribution level_s = 60.0;           ///< drawn for each level part; the first begins at a random point of it
  Distribution climb_s = 20.0;           ///< drawn for each climb or descent
  Distribution climb_mps = 0.0;          ///< magnitude, drawn for each; the sign is random
  Distribution acceleration_mps2 = 2.0;  ///< > 0, drawn once per flight

  /// [up_m, up_mps] (2 x samples) at times that ascend from 0, level at up_m first.
  Eigen::Matrix2Xd fly(std::span<const double> times_s, double up_m, RandomStream& stream) const;
};

}  // namespace truebearing
