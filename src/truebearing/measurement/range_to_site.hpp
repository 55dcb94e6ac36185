// SPDX-License-Identifier: Apache-2.0
// Ground range from a site to a state [east, north, v_east, v_north] in m and m/s: z = |position - site| (m = 1, n =
// 4). H = [u', 0] with u the unit vector from the site to the target.
#pragma once

#include <Eigen/Core>

#include "truebearing/measurement/measurement_model.hpp"

namespace truebearing {

template <typename ScalarType = double>
struct RangeToSite {
  using Scalar = ScalarType;
  static constexpr int kStates = 4;
  static constexpr int kMeasurements = 1;
  using State = Eigen::Matrix<Scalar, kStates, 1>;
  using Vector = Eigen::Matrix<Scalar, kMeasurements, 1>;
  using Jacobian = Eigen::Matrix<Scalar, kMeasurements, kStates>;
  using Covariance = Eigen::Matrix<Scalar, kMeasurements, kMeasurements>;

  Eigen::Matrix<Scalar, 2, 1> site_m;  ///< East, North
  Scalar sigma_m;

  Vector h(const State& x) const { return Vector((x.template head<2>() - site_m).norm()); }

  /// At the site itself the range has no derivative; H is zero there, so that the measurement leaves the state alone.
  Jacobian H(const State& x) const {
    const Eigen::Matrix<Scalar, 2, 1> offset_m = x.template head<2>() - site_m;
    const Scalar range_m = offset_m.norm();
    const Scalar inverse_range = range_m > 0 ? 1 / range_m : Scalar(0);
    return Jacobian(offset_m.x() * inverse_range, offset_m.y() * inverse_range, Scalar(0), Scalar(0));
  }

  Covariance R() const { return Covariance(sigma_m * sigma_m); }
  Vector residual(const Vector& z, const Vector& z_pred) const { return z - z_pred; }
};

static_assert(MeasurementModel<RangeToSite<>>);
static_assert(MeasurementModel<RangeToSite<float>>);

}  // namespace truebearing
