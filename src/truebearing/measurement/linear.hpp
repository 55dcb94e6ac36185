// SPDX-License-Identifier: Apache-2.0
// A known linear combination of the whole state: z = H x + v, H (m x n), R = diag(sigma^2).
#pragma once

#include <Eigen/Core>

#include "truebearing/measurement/measurement_model.hpp"

namespace truebearing {

template <int N, int M, typename ScalarType = double>
struct Linear {
  using Scalar = ScalarType;
  static constexpr int kStates = N;
  static constexpr int kMeasurements = M;
  using State = Eigen::Matrix<Scalar, kStates, 1>;
  using Vector = Eigen::Matrix<Scalar, kMeasurements, 1>;
  using Jacobian = Eigen::Matrix<Scalar, kMeasurements, kStates>;
  using Covariance = Eigen::Matrix<Scalar, kMeasurements, kMeasurements>;

  Jacobian matrix;
  Vector sigma;  ///< standard deviation of each component

  Vector h(const State& x) const { return matrix * x; }
  Jacobian H(const State&) const { return matrix; }
  Covariance R() const { return Covariance(sigma.array().square().matrix().asDiagonal()); }
  Vector residual(const Vector& z, const Vector& z_pred) const { return z - z_pred; }
};

static_assert(MeasurementModel<Linear<3, 3>>);
static_assert(MeasurementModel<Linear<3, 2, float>>);

}  // namespace truebearing
