// SPDX-License-Identifier: Apache-2.0
// The bearing of a target in the plane, x = [east, north, v_east, v_north] in m and m/s (n = 4), from a sensor that
// moves: z = [bearing_rad] (m = 1), clockwise from North, R = [sigma^2].
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "truebearing/core/angle.hpp"
#include "truebearing/measurement/measurement_model.hpp"

namespace truebearing {

template <typename ScalarType = double>
struct Bearing {
  using Scalar = ScalarType;
  static constexpr int kStates = 4;
  static constexpr int kMeasurements = 1;
  using State = Eigen::Matrix<Scalar, kStates, 1>;
  using Vector = Eigen::Matrix<Scalar, kMeasurements, 1>;
  using Jacobian = Eigen::Matrix<Scalar, kMeasurements, kStates>;
  using Covariance = Eigen::Matrix<Scalar, kMeasurements, kMeasurements>;
  using Plane = Eigen::Matrix<Scalar, 2, 1>;

  Plane site_m;             ///< of the sensor: East, North
  Plane site_velocity_mps;  ///< for filters whose state is relative to the sensor
  Scalar sigma_rad;

  /// In [-pi, pi].
  Vector h(const State& x) const { return Vector(std::atan2(x(0) - site_m.x(), x(1) - site_m.y())); }

  /// At the sensor itself the bearing has no derivative; H is zero there, so that the measurement leaves the state
  /// alone.
  Jacobian H(const State& x) const {
    const Plane offset_m = x.template head<2>() - site_m;
    const Scalar squared = offset_m.squaredNorm();
    const Scalar inverse = squared > 0 ? 1 / squared : Scalar(0);
    return Jacobian(offset_m.y() * inverse, -offset_m.x() * inverse, 0, 0);
  }

  /// g(z, x): h(x_true) - h(x) = g (x_true - x) exactly for every x_true that is seen at z (Song and Speyer 1985, here
  /// from North). With D the distance along z at which x is passed and a D by how far, it is atan(a) / (a D) times the
  /// direction across z. H where x lies behind, and with it g would be unbounded.
  Jacobian modified_gain(const Vector& z, const State& x) const {
    const Plane offset_m = x.template head<2>() - site_m;
    const Scalar sine = std::sin(z(0)), cosine = std::cos(z(0));
    const Scalar along_m = offset_m.x() * sine + offset_m.y() * cosine;
    if (!(along_m > 0)) return H(x);
    const Scalar a = (offset_m.x() * cosine - offset_m.y() * sine) / along_m;
    const Scalar slope = (a == 0 ? Scalar(1) : std::atan(a) / a) / along_m;
    return Jacobian(slope * cosine, -slope * sine, 0, 0);
  }

  Covariance R() const { return Covariance(sigma_rad * sigma_rad); }

  /// In [-pi, pi].
  Vector residual(const Vector& z, const Vector& z_pred) const {
    return Vector(static_cast<Scalar>(wrap_pi(z(0) - z_pred(0))));
  }
};

static_assert(MeasurementModel<Bearing<>>);
static_assert(MeasurementModel<Bearing<float>>);

}  // namespace truebearing
