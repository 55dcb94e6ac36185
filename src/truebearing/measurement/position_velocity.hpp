// SPDX-License-Identifier: Apache-2.0
// Position and velocity measured directly on a line: z = [position_m, velocity_mps] of a state [position, velocity].
// Linear, H = I (2 x 2), R = diag(sigma^2).
#pragma once

#include <Eigen/Core>

#include "truebearing/measurement/measured.hpp"
#include "truebearing/measurement/measurement_model.hpp"

namespace truebearing {

template <typename ScalarType = double>
struct PositionVelocity {
  using Scalar = ScalarType;
  static constexpr int kStates = 2;
  static constexpr int kMeasurements = 2;
  using State = Eigen::Matrix<Scalar, kStates, 1>;
  using Vector = Eigen::Matrix<Scalar, kMeasurements, 1>;
  using Jacobian = Eigen::Matrix<Scalar, kMeasurements, kStates>;
  using Covariance = Eigen::Matrix<Scalar, kMeasurements, kMeasurements>;

  static Measured measured() { return {"position_velocity", {"position_m", "velocity_mps"}}; }

  Vector sigma;  ///< m, m/s

  Vector h(const State& x) const { return x; }
  Jacobian H(const State&) const { return Jacobian::Identity(); }
  Covariance R() const { return Covariance(sigma.array().square().matrix().asDiagonal()); }
  Vector residual(const Vector& z, const Vector& z_pred) const { return z - z_pred; }
};

static_assert(MeasurementModel<PositionVelocity<>>);
static_assert(MeasurementModel<PositionVelocity<float>>);

}  // namespace truebearing
