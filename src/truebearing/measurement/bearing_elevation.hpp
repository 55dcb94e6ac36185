// SPDX-License-Identifier: Apache-2.0
// Bearing and elevation, without a range, from a site to a state [east, north, up, v_east, v_north, v_up] in m and m/s:
// z = [bearing_rad, elevation_rad] (m = 2, n = 6), R = diag(sigma^2).
#pragma once

#include <Eigen/Core>

#include "truebearing/core/angle.hpp"
#include "truebearing/measurement/measured.hpp"
#include "truebearing/measurement/measurement_model.hpp"
#include "truebearing/measurement/sight_in_space.hpp"

namespace truebearing {

template <typename ScalarType = double>
struct BearingElevation {
  using Scalar = ScalarType;
  static constexpr int kStates = 6;
  static constexpr int kMeasurements = 2;
  using State = Eigen::Matrix<Scalar, kStates, 1>;
  using Vector = Eigen::Matrix<Scalar, kMeasurements, 1>;
  using Jacobian = Eigen::Matrix<Scalar, kMeasurements, kStates>;
  using Covariance = Eigen::Matrix<Scalar, kMeasurements, kMeasurements>;
  using Place = Eigen::Matrix<Scalar, 3, 1>;

  static Measured measured() { return {"bearing_elevation", {"bearing_deg", "elevation_deg"}}; }

  Place site_m;      ///< East, North, up
  Vector sigma_rad;  ///< of bearing and elevation

  Vector h(const State& x) const {
    const SightInSpace<Scalar> sight(x.template head<3>() - site_m);
    return {sight.bearing_rad, sight.elevation_rad};
  }

  Jacobian H(const State& x) const {
    const SightInSpace<Scalar> sight(x.template head<3>() - site_m);
    Jacobian jacobian = Jacobian::Zero();
    jacobian.template leftCols<3>() << sight.bearing_slope.transpose(), sight.elevation_slope.transpose();
    return jacobian;
  }

  Covariance R() const { return sigma_rad.cwiseAbs2().asDiagonal(); }

  /// The bearing's component in [-pi, pi].
  Vector residual(const Vector& z, const Vector& z_pred) const {
    return {static_cast<Scalar>(wrap_pi(z(0) - z_pred(0))), z(1) - z_pred(1)};
  }
};

static_assert(MeasurementModel<BearingElevation<>>);
static_assert(MeasurementModel<BearingElevation<float>>);

}  // namespace truebearing
