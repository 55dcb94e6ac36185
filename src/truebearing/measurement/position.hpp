// SPDX-License-Identifier: Apache-2.0
// Positions measured directly: z = [positions (Dim)] of a state [positions (Dim), velocities (Dim)]. Linear,
// H = [I, 0] (m x n, m = Dim, n = 2 Dim), R = diag(sigma^2).
#pragma once

#include <Eigen/Core>

#include "truebearing/measurement/measurement_model.hpp"

namespace truebearing {

template <int Dim, typename ScalarType = double>
struct Position {
  using Scalar = ScalarType;
  static constexpr int kStates = 2 * Dim;
  static constexpr int kMeasurements = Dim;
  using State = Eigen::Matrix<Scalar, kStates, 1>;
  using Vector = Eigen::Matrix<Scalar, kMeasurements, 1>;
  using Jacobian = Eigen::Matrix<Scalar, kMeasurements, kStates>;
  using Covariance = Eigen::Matrix<Scalar, kMeasurements, kMeasurements>;

  Vector sigma_m;  ///< standard deviation of each component

  Vector h(const State& x) const { return x.template head<Dim>(); }
  Jacobian H(const State&) const { return Jacobian::Identity(); }
  Covariance R() const { return Covariance(sigma_m.array().square().matrix().asDiagonal()); }
  Vector residual(const Vector& z, const Vector& z_pred) const { return z - z_pred; }
};

static_assert(MeasurementModel<Position<1>>);
static_assert(MeasurementModel<Position<2, float>>);

}  // namespace truebearing
