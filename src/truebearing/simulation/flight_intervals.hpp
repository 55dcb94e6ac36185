// SPDX-License-Identifier: Apache-2.0
// A flight of a number of intervals, in each of which a target accelerates along and across its velocity as it is drawn
// for that interval. The acceleration is aimed by the velocity once in each hold_s and keeps its direction until the next
// time: between these the path is a parabola. With hold_s = 1 s the targets of Greenberg, Mannor and Yannay's lidar
// (Optimization or Architecture: How to Hack Kalman Filtering, 2023).
#pragma once

#include <Eigen/Core>
#include <span>

#include "truebearing/core/random.hpp"
#include "truebearing/simulation/distribution.hpp"

namespace truebearing {

struct FlightIntervals {
  Distribution count = 5.0;        ///< drawn once per flight, rounded
  Distribution interval_s = 6.0;   ///< drawn for each interval, as a whole number of hold_s
  Distribution along_mps2 = 0.0;   ///< drawn for each, forwards
  Distribution across_mps2 = 0.0;  ///< drawn for each, to starboard
  double hold_s = 1.0;

  /// At times that ascend from 0, from the origin at that velocity; sets end_s. What comes after the end is straight.
  Eigen::Matrix4Xd fly(std::span<const double> times_s, const Eigen::Vector2d& velocity_mps, RandomStream& stream,
                       double& end_s) const;

  bool operator==(const FlightIntervals&) const = default;
};

}  // namespace truebearing
