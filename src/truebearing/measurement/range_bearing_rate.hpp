// SPDX-License-Identifier: Apache-2.0
// Range, bearing and range rate from a site that may move to a state [east, north, v_east, v_north] in m and m/s:
// z = [range_m, bearing_rad, range_rate_mps] (m = 3, n = 4), bearings clockwise from North,
//     range rate = u . (v - v_site),  u = [sin bearing, cos bearing]
// Bar-Shalom, Li and Kirubarajan 2001, section 10.4.3. R = diag(sigma^2) but for the correlation of range and range rate that
// a chirp couples.
#pragma once

#include <Eigen/Core>

#include "truebearing/measurement/measured.hpp"
#include "truebearing/measurement/range_bearing.hpp"

namespace truebearing {

template <typename ScalarType = double>
struct RangeBearingRate {
  using Scalar = ScalarType;
  static constexpr int kStates = 4;
  static constexpr int kMeasurements = 3;
  using State = Eigen::Matrix<Scalar, kStates, 1>;
  using Vector = Eigen::Matrix<Scalar, kMeasurements, 1>;
  using Jacobian = Eigen::Matrix<Scalar, kMeasurements, kStates>;
  using Covariance = Eigen::Matrix<Scalar, kMeasurements, kMeasurements>;
  using Plane = Eigen::Matrix<Scalar, 2, 1>;

  static Measured measured() { return {"range_bearing_rate", {"range_m", "bearing_deg", "range_rate_mps"}}; }

  Plane site_m;             ///< of the sensor: East, North
  Plane site_velocity_mps;  ///< of the sensor
  Scalar sigma_range_m;
  Scalar sigma_bearing_rad;
  Scalar sigma_rate_mps;
  Scalar correlation = 0;  ///< of range and range rate, in (-1, 1)

  /// The bearing in [-pi, pi]. At the site itself the range rate is zero.
  Vector h(const State& x) const {
    Vector z;
    z << polar().h(x), sight(x).dot(relative_velocity(x));
    return z;
  }

  /// d rate / d position = (w - u (u . w)) / range with w = v - v_site, d rate / d velocity = u. Zero at the site
  /// itself, so that the measurement leaves the state alone.
  Jacobian H(const State& x) const {
    const Plane offset_m = x.template head<2>() - site_m;
    const Scalar range_m = offset_m.norm();
    const Scalar inverse_range = range_m > 0 ? 1 / range_m : Scalar(0);
    const Plane u = sight(x), w = relative_velocity(x);
    const Plane across = (w - u * u.dot(w)) * inverse_range;
    Jacobian jacobian;
    jacobian << polar().H(x), across.x(), across.y(), u.x(), u.y();
    return jacobian;
  }

  Covariance R() const {
    Covariance covariance = Vector(sigma_range_m, sigma_bearing_rad, sigma_rate_mps).cwiseAbs2().asDiagonal();
    covariance(0, 2) = covariance(2, 0) = correlation * sigma_range_m * sigma_rate_mps;
    return covariance;
  }

  /// The bearing's component in [-pi, pi].
  Vector residual(const Vector& z, const Vector& z_pred) const {
    Vector difference;
    difference << polar().residual(z.template head<2>(), z_pred.template head<2>()), z(2) - z_pred(2);
    return difference;
  }

 private:
  RangeBearing<Scalar> polar() const { return {site_m, sigma_range_m, sigma_bearing_rad}; }
  Plane relative_velocity(const State& x) const { return x.template tail<2>() - site_velocity_mps; }
  Plane sight(const State& x) const {
    const Plane offset_m = x.template head<2>() - site_m;
    const Scalar range_m = offset_m.norm();
    return range_m > 0 ? Plane(offset_m / range_m) : Plane(Plane::Zero());
  }
};

static_assert(MeasurementModel<RangeBearingRate<>>);
static_assert(MeasurementModel<RangeBearingRate<float>>);

}  // namespace truebearing
