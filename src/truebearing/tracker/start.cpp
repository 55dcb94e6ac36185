// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tracker/start.hpp"

#include <cmath>

namespace truebearing {

PriorStart one_point_state(PositionFix fix, const OnePointStart& one_point) {
  const double velocity_sigma_mps = one_point.velocity_sigma_mps, position_sigma_m = one_point.position_sigma_m;
  const Eigen::Index d = fix.z.size();
  if (position_sigma_m > 0.0) fix.R = position_sigma_m * position_sigma_m * BoundedMatrix::Identity(d, d);
  PriorStart start{BoundedVector::Zero(2 * d),
                   velocity_sigma_mps * velocity_sigma_mps * BoundedMatrix::Identity(2 * d, 2 * d)};
  start.x.head(d) = fix.z;
  start.P.topLeftCorner(d, d) = fix.R;
  if (one_point.climb_sigma_mps > 0.0) start.P(2 * d - 1, 2 * d - 1) = std::pow(one_point.climb_sigma_mps, 2.0);
  return start;
}

PriorStart with_climb(PriorStart start, double climb_sigma_mps) {
  if (start.x.size() == 6 && std::isfinite(climb_sigma_mps)) start.P(5, 5) = climb_sigma_mps * climb_sigma_mps;
  return start;
}

PriorStart two_point_state(const PositionFix& first, const PositionFix& second, double dt_s) {
  const Eigen::Index d = second.z.size();
  PriorStart start{BoundedVector(2 * d), BoundedMatrix(2 * d, 2 * d)};
  start.x << second.z, (second.z - first.z) / dt_s;
  start.P << second.R, second.R / dt_s, second.R / dt_s, (first.R + second.R) / (dt_s * dt_s);
  return start;
}

PriorStart lengthened(const PriorStart& start, int states, double rest_sigma) {
  const Eigen::Index n = start.x.size();
  PriorStart longer{BoundedVector::Zero(states), rest_sigma * rest_sigma * BoundedMatrix::Identity(states, states),
                    start.time_s};
  longer.x.head(n) = start.x;
  longer.P.topLeftCorner(n, n) = start.P;
  return longer;
}

}  // namespace truebearing
