// SPDX-License-Identifier: Apache-2.0
// A position with correlated errors and, independent of it, a speed that is linear in the state [positions (D),
// velocities (D)] in m and m/s: z = [position (D), rate] (m = D + 1, n = 2 D),
//     h(x) = [H x; row x + offset],  H = [I, 0],  R = [R_m2, 0; 0, sigma_rate^2]
// What a Doppler radar's measurement becomes where it is converted: along the direction in which the target is measured,
// or, where the rate is linearised about the estimate that the position leaves, the two updates one after the other.
#pragma once

#include <Eigen/Core>

#include "truebearing/measurement/measurement_model.hpp"

namespace truebearing {

template <int D, typename ScalarType = double>
struct PositionAndRate {
  using Scalar = ScalarType;
  static constexpr int kStates = 2 * D;
  static constexpr int kMeasurements = D + 1;
  using State = Eigen::Matrix<Scalar, kStates, 1>;
  using Vector = Eigen::Matrix<Scalar, kMeasurements, 1>;
  using Jacobian = Eigen::Matrix<Scalar, kMeasurements, kStates>;
  using Covariance = Eigen::Matrix<Scalar, kMeasurements, kMeasurements>;

  Eigen::Matrix<Scalar, D, D> R_m2;  ///< of the position
  State row;                         ///< of the rate, transposed
  Scalar offset_mps = 0;
  Scalar sigma_rate_mps;

  Vector h(const State& x) const {
    Vector z;
    z << x.template head<D>(), row.dot(x) + offset_mps;
    return z;
  }
  Jacobian H(const State&) const {
    Jacobian jacobian = Jacobian::Identity();
    jacobian.template bottomRows<1>() = row.transpose();
    return jacobian;
  }
  Covariance R() const {
    Covariance covariance = Covariance::Zero();
    covariance.template topLeftCorner<D, D>() = R_m2;
    covariance(D, D) = sigma_rate_mps * sigma_rate_mps;
    return covariance;
  }
  Vector residual(const Vector& z, const Vector& z_pred) const { return z - z_pred; }
};

static_assert(MeasurementModel<PositionAndRate<2>>);
static_assert(MeasurementModel<PositionAndRate<3, float>>);

}  // namespace truebearing
