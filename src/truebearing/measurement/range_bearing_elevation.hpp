// SPDX-License-Identifier: Apache-2.0
// Range, bearing and elevation from a site to a state [east, north, up, v_east, v_north, v_up] in m and m/s:
// z = [range_m, bearing_rad, elevation_rad] (m = 3, n = 6), R = diag(sigma^2). And the conversion of such a z to an
// unbiased position.
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "truebearing/core/angle.hpp"
#include "truebearing/measurement/measured.hpp"
#include "truebearing/measurement/measurement_model.hpp"
#include "truebearing/measurement/sight_in_space.hpp"

namespace truebearing {

template <typename ScalarType = double>
struct RangeBearingElevation {
  using Scalar = ScalarType;
  static constexpr int kStates = 6;
  static constexpr int kMeasurements = 3;
  using State = Eigen::Matrix<Scalar, kStates, 1>;
  using Vector = Eigen::Matrix<Scalar, kMeasurements, 1>;
  using Jacobian = Eigen::Matrix<Scalar, kMeasurements, kStates>;
  using Covariance = Eigen::Matrix<Scalar, kMeasurements, kMeasurements>;

  static Measured measured() { return {"range_bearing_elevation", {"range_m", "bearing_deg", "elevation_deg"}}; }

  Vector site_m;  ///< East, North, up
  Vector sigma;   ///< m, rad, rad

  Vector h(const State& x) const {
    const SightInSpace<Scalar> sight(x.template head<3>() - site_m);
    return {sight.range_m, sight.bearing_rad, sight.elevation_rad};
  }

  Jacobian H(const State& x) const {
    const SightInSpace<Scalar> sight(x.template head<3>() - site_m);
    Jacobian jacobian = Jacobian::Zero();
    jacobian.template leftCols<3>() << sight.along.transpose(), sight.bearing_slope.transpose(),
        sight.elevation_slope.transpose();
    return jacobian;
  }

  Covariance R() const { return sigma.cwiseAbs2().asDiagonal(); }

  /// The bearing's component in [-pi, pi]; an elevation does not wrap.
  Vector residual(const Vector& z, const Vector& z_pred) const {
    Vector difference = z - z_pred;
    difference(1) = static_cast<Scalar>(wrap_pi(difference(1)));
    return difference;
  }
};

static_assert(MeasurementModel<RangeBearingElevation<>>);
static_assert(MeasurementModel<RangeBearingElevation<float>>);

/// z = [range_m, bearing_rad, elevation_rad] seen from site_m as a position (3) whose error has mean zero: the factors
/// exp(sigma^2 / 2) are for what the spread of each angle takes from the mean, as in the plane (range_bearing.hpp).
inline Eigen::Vector3d convert_range_bearing_elevation(const Eigen::Vector3d& z, const Eigen::Vector3d& sigma,
                                                       const Eigen::Vector3d& site_m) {
  const double of_bearing = std::exp(0.5 * sigma[1] * sigma[1]), of_elevation = std::exp(0.5 * sigma[2] * sigma[2]);
  const double level = of_bearing * of_elevation * z[0] * std::cos(z[2]);
  return site_m + Eigen::Vector3d(level * std::sin(z[1]), level * std::cos(z[1]), of_elevation * z[0] * std::sin(z[2]));
}

/// The covariance (3 x 3) of a position that was converted so, of a target at offset_m (3) from the site. With b and e
/// the variances of the two angles, c and s cosine and sine of the elevation, p = cosh b - 1, q = cosh e - 1, and
/// s_r^2 that of the range, across, level and up,
///     across    (r^2 + s_r^2) sinh b (cosh e c^2 + sinh e s^2)
///     level     r^2 ((p + q + p q) c^2 + cosh b sinh e s^2) + s_r^2 cosh b (cosh e c^2 + sinh e s^2)
///     up        r^2 (q s^2 + sinh e c^2) + s_r^2 (cosh e s^2 + sinh e c^2)
///     level up  s c (r^2 (exp -e - 1) + s_r^2 exp -e)
/// which are the moments of the conversion without differences of nearly equal terms of the size r^2.
inline Eigen::Matrix3d converted_covariance(const Eigen::Vector3d& offset_m, const Eigen::Vector3d& sigma) {
  const SightInSpace<double> sight(offset_m);
  const double r2 = sight.range_m * sight.range_m, range_variance = sigma[0] * sigma[0];
  const double b = sigma[1] * sigma[1], e = sigma[2] * sigma[2];
  const double sine = std::sin(sight.elevation_rad), cosine = std::cos(sight.elevation_rad);
  const double s2 = sine * sine, c2 = cosine * cosine;
  const auto cosh_less_one = [](double x) { return 2.0 * std::sinh(0.5 * x) * std::sinh(0.5 * x); };
  const double p = cosh_less_one(b), q = cosh_less_one(e), sinh_e = std::sinh(e);
  const double cosine_square = (1.0 + q) * c2 + sinh_e * s2;  // of the elevation as it is measured, corrected
  Eigen::Matrix3d R;                                          // level along, across, up
  R.setZero();
  R(0, 0) = r2 * ((p + q + p * q) * c2 + (1.0 + p) * sinh_e * s2) + range_variance * (1.0 + p) * cosine_square;
  R(1, 1) = (r2 + range_variance) * std::sinh(b) * cosine_square;
  R(2, 2) = r2 * (q * s2 + sinh_e * c2) + range_variance * ((1.0 + q) * s2 + sinh_e * c2);
  R(0, 2) = R(2, 0) = sine * cosine * (r2 * std::expm1(-e) + range_variance * std::exp(-e));
  const double east = std::sin(sight.bearing_rad), north = std::cos(sight.bearing_rad);
  Eigen::Matrix3d axes;  // columns: level along the sight, across it to starboard, up
  axes << east, north, 0.0, north, -east, 0.0, 0.0, 0.0, 1.0;
  return axes * R * axes.transpose();
}

}  // namespace truebearing
