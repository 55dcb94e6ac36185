// SPDX-License-Identifier: Apache-2.0
// Range, bearing, elevation and range rate from a site that may move to a state [east, north, up, v_east, v_north,
// v_up] in m and m/s: z = [range_m, bearing_rad, elevation_rad, range_rate_mps] (m = 4, n = 6). R = diag(sigma^2) but
// for the correlation of range and range rate that a chirp couples.
#pragma once

#include <Eigen/Core>

#include "truebearing/measurement/range_bearing_elevation.hpp"

namespace truebearing {

template <typename ScalarType = double>
struct RangeBearingElevationRate {
  using Scalar = ScalarType;
  static constexpr int kStates = 6;
  static constexpr int kMeasurements = 4;
  using State = Eigen::Matrix<Scalar, kStates, 1>;
  using Vector = Eigen::Matrix<Scalar, kMeasurements, 1>;
  using Jacobian = Eigen::Matrix<Scalar, kMeasurements, kStates>;
  using Covariance = Eigen::Matrix<Scalar, kMeasurements, kMeasurements>;
  using Place = Eigen::Matrix<Scalar, 3, 1>;

  static Measured measured() {
    return {"range_bearing_elevation_rate", {"range_m", "bearing_deg", "elevation_deg", "range_rate_mps"}};
  }

  Place site_m;             ///< of the sensor: East, North, up
  Place site_velocity_mps;  ///< of the sensor
  Vector sigma;             ///< m, rad, rad, m/s
  Scalar correlation = 0;   ///< of range and range rate, in (-1, 1)

  /// At the site itself the range rate is zero.
  Vector h(const State& x) const {
    const SightInSpace<Scalar> sight(x.template head<3>() - site_m);
    return {sight.range_m, sight.bearing_rad, sight.elevation_rad, sight.range_rate(relative_velocity(x))};
  }

  /// The range rate's derivative in the velocity is the unit vector along the sight.
  Jacobian H(const State& x) const {
    const SightInSpace<Scalar> sight(x.template head<3>() - site_m);
    Jacobian jacobian = Jacobian::Zero();
    jacobian.template leftCols<3>() << sight.along.transpose(), sight.bearing_slope.transpose(),
        sight.elevation_slope.transpose(), sight.range_rate_slope(relative_velocity(x)).transpose();
    jacobian.template block<1, 3>(3, 3) = sight.along.transpose();
    return jacobian;
  }

  Covariance R() const {
    Covariance covariance = sigma.cwiseAbs2().asDiagonal();
    covariance(0, 3) = covariance(3, 0) = correlation * sigma(0) * sigma(3);
    return covariance;
  }

  /// The bearing's component in [-pi, pi].
  Vector residual(const Vector& z, const Vector& z_pred) const {
    Vector difference = z - z_pred;
    difference(1) = static_cast<Scalar>(wrap_pi(difference(1)));
    return difference;
  }

 private:
  Place relative_velocity(const State& x) const { return x.template tail<3>() - site_velocity_mps; }
};

static_assert(MeasurementModel<RangeBearingElevationRate<>>);
static_assert(MeasurementModel<RangeBearingElevationRate<float>>);

}  // namespace truebearing
