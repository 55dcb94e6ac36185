// SPDX-License-Identifier: Apache-2.0
// Positions measured directly with correlated errors: z = [positions (Dim)] of a state [positions (Dim), velocities
// (Dim)] in m and m/s. Linear, H = [I, 0] (m x n, m = Dim, n = 2 Dim), R = R_m2 (m x m), as a conversion from polar
// coordinates leaves it.
#pragma once

#include <Eigen/Core>

#include "truebearing/measurement/measurement_model.hpp"

namespace truebearing {

template <int Dim, typename ScalarType = double>
struct CartesianPosition {
  using Scalar = ScalarType;
  static constexpr int kStates = 2 * Dim;
  static constexpr int kMeasurements = Dim;
  using State = Eigen::Matrix<Scalar, kStates, 1>;
  using Vector = Eigen::Matrix<Scalar, kMeasurements, 1>;
  using Jacobian = Eigen::Matrix<Scalar, kMeasurements, kStates>;
  using Covariance = Eigen::Matrix<Scalar, kMeasurements, kMeasurements>;

  Covariance R_m2;  ///< symmetric positive semi-definite

  Vector h(const State& x) const { return x.template head<Dim>(); }
  Jacobian H(const State&) const { return Jacobian::Identity(); }
  Covariance R() const { return R_m2; }
  Vector residual(const Vector& z, const Vector& z_pred) const { return z - z_pred; }
};

static_assert(MeasurementModel<CartesianPosition<1>>);
static_assert(MeasurementModel<CartesianPosition<2, float>>);

}  // namespace truebearing
