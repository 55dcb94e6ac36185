// SPDX-License-Identifier: Apache-2.0
// Bearing and Doppler-shifted frequency of a target in the plane, x = [east, north, v_east, v_north, f0] in m, m/s and
// Hz (n = 5), from a sensor that moves: z = [bearing_rad, frequency_hz] (m = 2), the bearing clockwise from North,
//     f = f0 (1 - v_r / c),  v_r = (v - v_site) . u,  u = [sin bearing, cos bearing]
//     R = diag(sigma^2)
// (Kim and Song, equation 4, exact where theirs drops f0 v_r). Either component may be missing: its row of H is then
// zero, its residual zero and its noise one, so that it changes neither estimate nor likelihood.
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "truebearing/core/angle.hpp"
#include "truebearing/measurement/bearing.hpp"
#include "truebearing/measurement/measurement_model.hpp"

namespace truebearing {

inline constexpr double kSoundInWater_mps = 1500.0;

template <typename ScalarType = double>
struct BearingFrequency {
  using Scalar = ScalarType;
  static constexpr int kStates = 5;
  static constexpr int kMeasurements = 2;
  using State = Eigen::Matrix<Scalar, kStates, 1>;
  using Vector = Eigen::Matrix<Scalar, kMeasurements, 1>;
  using Jacobian = Eigen::Matrix<Scalar, kMeasurements, kStates>;
  using Covariance = Eigen::Matrix<Scalar, kMeasurements, kMeasurements>;
  using Plane = Eigen::Matrix<Scalar, 2, 1>;

  Plane site_m;             ///< of the sensor: East, North
  Plane site_velocity_mps;  ///< of the sensor
  Scalar sigma_rad;
  Scalar sigma_hz;
  Scalar sound_mps = Scalar(kSoundInWater_mps);  ///< c
  bool has_bearing = true;
  bool has_frequency = true;

  /// The bearing in [-pi, pi]; 0 in place of what is missing.
  Vector h(const State& x) const {
    return Vector(has_bearing ? bearing().h(x.template head<4>())(0) : Scalar(0),
                  has_frequency ? x(4) * shift(x, sight(x)) : Scalar(0));
  }

  /// At the sensor itself the line of sight has no direction: there the frequency depends on f0 alone.
  Jacobian H(const State& x) const {
    Jacobian jacobian = Jacobian::Zero();
    const Plane u = sight(x);
    const Eigen::Matrix<Scalar, 1, 4> bearing_row = bearing().H(x.template head<4>());
    if (has_bearing) jacobian.template topLeftCorner<1, 4>() = bearing_row;
    if (!has_frequency) return jacobian;
    // dv_r = u . dv + (v - v_site) . du,  du = [u_y, -u_x] d bearing
    const Plane v = x.template segment<2>(2) - site_velocity_mps;
    const Scalar along = -x(4) / sound_mps, across = v.x() * u.y() - v.y() * u.x();
    jacobian.template block<1, 2>(1, 0) = along * across * bearing_row.template head<2>();
    jacobian.template block<1, 2>(1, 2) = along * u.transpose();
    jacobian(1, 4) = shift(x, u);
    return jacobian;
  }

  /// g(z, x): the bearing's row as in bearing.hpp; the frequency's with v_r(x_true) - v_r(x) = u(z) . dv + beta
  /// d bearing, beta = (v - v_site) . (u(z) - u(x)) / (z - h(x)), exact but for the product of the errors of f0 and
  /// v_r. (Song and Speyer 1985; Kim and Song's equation 15 with velocities for the printed positions.)
  Jacobian modified_gain(const Vector& z, const State& x) const {
    if (!has_bearing) return H(x);
    Jacobian g = Jacobian::Zero();
    const RadialRow row = radial_row(z(0), x);
    g.template topLeftCorner<1, 4>() = row.bearing;
    if (!has_frequency) return g;
    g.template block<1, 4>(1, 0) = -x(4) / sound_mps * row.radial;
    g(1, 4) = shift(x, sight(x));
    return g;
  }

  Covariance R() const {
    return Vector(has_bearing ? sigma_rad * sigma_rad : Scalar(1), has_frequency ? sigma_hz * sigma_hz : Scalar(1))
        .asDiagonal();
  }

  /// The bearing's in [-pi, pi]; 0 in place of what is missing.
  Vector residual(const Vector& z, const Vector& z_pred) const {
    return Vector(has_bearing ? static_cast<Scalar>(wrap_pi(z(0) - z_pred(0))) : Scalar(0),
                  has_frequency ? z(1) - z_pred(1) : Scalar(0));
  }

  /// Rows over [east, north, v_east, v_north] whose products with x_true - x are, exactly where x_true is seen at z,
  /// the changes of the bearing (rad) and of the radial velocity (m/s).
  struct RadialRow {
    Eigen::Matrix<Scalar, 1, 4> bearing;
    Eigen::Matrix<Scalar, 1, 4> radial;
  };
  RadialRow radial_row(Scalar z_rad, const State& x) const {
    const Plane measured(std::sin(z_rad), std::cos(z_rad));
    const Plane v = x.template segment<2>(2) - site_velocity_mps;
    const Eigen::Matrix<Scalar, 4, 1> plane = x.template head<4>();
    const Eigen::Matrix<Scalar, 1, 1> z(z_rad);
    const Scalar d = bearing().residual(z, bearing().h(plane))(0);
    // u(z) - u(x) = 2 sin(d / 2) [cos m, -sin m] with m the mean of the two bearings: no cancellation as d -> 0.
    const Scalar mean = z_rad - d / 2, half = d / 2;
    const Scalar chord = half == 0 ? Scalar(1) : std::sin(half) / half;
    const Scalar beta = chord * (v.x() * std::cos(mean) - v.y() * std::sin(mean));
    RadialRow row;
    row.bearing = bearing().modified_gain(z, plane);
    row.radial = beta * row.bearing;
    row.radial.template tail<2>() += measured.transpose();
    return row;
  }

 private:
  Bearing<Scalar> bearing() const { return {site_m, site_velocity_mps, sigma_rad}; }

  Plane sight(const State& x) const {
    const Plane offset_m = x.template head<2>() - site_m;
    const Scalar range_m = offset_m.norm();
    return range_m > 0 ? Plane(offset_m / range_m) : Plane(Plane::Zero());
  }

  Scalar shift(const State& x, const Plane& u) const {
    return 1 - u.dot(x.template segment<2>(2) - site_velocity_mps) / sound_mps;
  }
};

static_assert(MeasurementModel<BearingFrequency<>>);
static_assert(MeasurementModel<BearingFrequency<float>>);

}  // namespace truebearing
