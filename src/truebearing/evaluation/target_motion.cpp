// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/target_motion.hpp"

#include <cmath>

#include "truebearing/core/angle.hpp"

namespace truebearing {
namespace {

double course_rad(const Eigen::Vector4d& x) {
  return std::atan2(x(2), x(3));
}

double variance(const Eigen::Matrix2d& P, const Eigen::Vector2d& gradient) {
  return gradient.dot(P * gradient);
}

}  // namespace

TargetMotionError target_motion_error(const Eigen::Vector4d& truth, const Eigen::Vector4d& estimate,
                                      const SensorState& own_ship) {
  const double range_m = (truth.head<2>() - own_ship.position_m).norm();
  return {100.0 * ((estimate.head<2>() - own_ship.position_m).norm() / range_m - 1.0),
          degrees(wrap_pi(course_rad(estimate) - course_rad(truth))),
          estimate.tail<2>().norm() - truth.tail<2>().norm()};
}

TargetMotionVariance target_motion_variance(const Eigen::Vector4d& truth, const Eigen::Matrix4d& P,
                                            const SensorState& own_ship) {
  const Eigen::Vector2d offset_m = truth.head<2>() - own_ship.position_m, v = truth.tail<2>();
  const Eigen::Matrix2d position = P.topLeftCorner<2, 2>(), velocity = P.bottomRightCorner<2, 2>();
  const double range_m = offset_m.norm(), speed = v.norm();
  return {position.trace(),
          velocity.trace(),
          variance(position, 100.0 * offset_m / (range_m * range_m)),
          variance(velocity, degrees(1.0) * Eigen::Vector2d(v.y(), -v.x()) / (speed * speed)),
          variance(velocity, v / speed),
          std::numeric_limits<double>::quiet_NaN()};
}

}  // namespace truebearing
