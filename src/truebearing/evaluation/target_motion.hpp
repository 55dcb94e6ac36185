// SPDX-License-Identifier: Apache-2.0
// A target in the plane as a captain asks for it: its range from own ship, its course, its speed. Errors of an estimate
// in these, and what a covariance of the state [east, north, v_east, v_north] (n = 4) says of them.
#pragma once

#include <Eigen/Core>
#include <limits>

#include "truebearing/measurement/measurement.hpp"

namespace truebearing {

/// Estimate minus truth; the range in percent of the true one. NaN where there is no estimate.
struct TargetMotionError {
  double range_percent = std::numeric_limits<double>::quiet_NaN();
  double course_deg = std::numeric_limits<double>::quiet_NaN();  ///< in [-180, 180]
  double speed_mps = std::numeric_limits<double>::quiet_NaN();
};

TargetMotionError target_motion_error(const Eigen::Vector4d& truth, const Eigen::Vector4d& estimate,
                                      const SensorState& own_ship);

/// Variances of errors with a covariance about the truth, to first order; position and velocity are the traces.
struct TargetMotionVariance {
  double position_m2 = std::numeric_limits<double>::quiet_NaN();
  double velocity_m2ps2 = std::numeric_limits<double>::quiet_NaN();
  double range_percent2 = std::numeric_limits<double>::quiet_NaN();
  double course_deg2 = std::numeric_limits<double>::quiet_NaN();
  double speed_m2ps2 = std::numeric_limits<double>::quiet_NaN();
  double frequency_hz2 = std::numeric_limits<double>::quiet_NaN();  ///< of the source, where it is in the state
};

/// Of the covariance P of the state, which has no frequency.
TargetMotionVariance target_motion_variance(const Eigen::Vector4d& truth, const Eigen::Matrix4d& P,
                                            const SensorState& own_ship);

}  // namespace truebearing
