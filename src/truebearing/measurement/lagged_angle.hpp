// SPDX-License-Identifier: Apache-2.0
// An angle as it was lag_s ago, of a state [angle, rate]: h(x) = angle - lag_s rate, H = [1, -lag_s], R = sigma^2.
// What is made of an interval's snapshots belongs to a time before the interval's end.
#pragma once

#include <Eigen/Core>

#include "truebearing/measurement/measurement_model.hpp"

namespace truebearing {

struct LaggedAngle {
  using Scalar = double;
  static constexpr int kStates = 2;
  static constexpr int kMeasurements = 1;
  using Vector = Eigen::Matrix<double, 1, 1>;

  double lag_s = 0.0;
  double variance_rad2 = 1.0;

  Vector h(const Eigen::Vector2d& x) const { return Vector(x[0] - lag_s * x[1]); }
  Eigen::RowVector2d H(const Eigen::Vector2d&) const { return {1.0, -lag_s}; }
  Eigen::Matrix<double, 1, 1> R() const { return Eigen::Matrix<double, 1, 1>(variance_rad2); }
  /// From broadside no angle wraps.
  Vector residual(const Vector& z, const Vector& z_predicted) const { return z - z_predicted; }
};

static_assert(MeasurementModel<LaggedAngle>);

}  // namespace truebearing
