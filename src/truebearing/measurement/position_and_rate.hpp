// SPDX-License-Identifier: Apache-2.0
// A position with correlated errors and the speed along a direction u that is taken as known, of a state [east, north,
// up, v_east, v_north, v_up] in m and m/s: z = [position (3), speed - c distance] (m = 4, n = 6), linear,
//     H = [I, 0; -c u', u'],   R = [R_m2, 0; 0, sigma_rate^2]
// What a Doppler radar's measurement becomes where it is converted along its measured direction. With c = rho sigma_rate
// / sigma_range the range rate's error that goes with the range's is taken out, and the two are independent.
#pragma once

#include <Eigen/Core>

#include "truebearing/measurement/measurement_model.hpp"

namespace truebearing {

template <typename ScalarType = double>
struct PositionAndRate {
  using Scalar = ScalarType;
  static constexpr int kStates = 6;
  static constexpr int kMeasurements = 4;
  using State = Eigen::Matrix<Scalar, kStates, 1>;
  using Vector = Eigen::Matrix<Scalar, kMeasurements, 1>;
  using Jacobian = Eigen::Matrix<Scalar, kMeasurements, kStates>;
  using Covariance = Eigen::Matrix<Scalar, kMeasurements, kMeasurements>;

  Eigen::Matrix<Scalar, 3, 3> R_m2;   ///< of the position
  Eigen::Matrix<Scalar, 3, 1> along;  ///< u, of length 1
  Scalar distance_share = 0;          ///< c, 1/s
  Scalar sigma_rate_mps;

  Vector h(const State& x) const { return H(x) * x; }
  Jacobian H(const State&) const {
    Jacobian jacobian = Jacobian::Zero();
    jacobian.template topLeftCorner<3, 3>().setIdentity();
    jacobian.template block<1, 3>(3, 0) = -distance_share * along.transpose();
    jacobian.template block<1, 3>(3, 3) = along.transpose();
    return jacobian;
  }
  Covariance R() const {
    Covariance covariance = Covariance::Zero();
    covariance.template topLeftCorner<3, 3>() = R_m2;
    covariance(3, 3) = sigma_rate_mps * sigma_rate_mps;
    return covariance;
  }
  Vector residual(const Vector& z, const Vector& z_pred) const { return z - z_pred; }
};

static_assert(MeasurementModel<PositionAndRate<>>);
static_assert(MeasurementModel<PositionAndRate<float>>);

}  // namespace truebearing
