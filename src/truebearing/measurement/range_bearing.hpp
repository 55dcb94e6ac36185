// SPDX-License-Identifier: Apache-2.0
// Range and bearing from a site to a state [east, north, v_east, v_north] in m and m/s: z = [range_m, bearing_rad] (m =
// 2, n = 4), bearings clockwise from North, R = diag(sigma^2). And the conversion of such a z to an unbiased position:
// Mo, Song, Zhou, Sun and Bar-Shalom 1998, and for a track Bordonaro, Willett and Bar-Shalom 2014.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <type_traits>

#include "truebearing/core/angle.hpp"
#include "truebearing/measurement/measurement_model.hpp"
#include "truebearing/measurement/range_bearing_points.hpp"

namespace truebearing {

template <typename ScalarType = double>
struct RangeBearing {
  using Scalar = ScalarType;
  static constexpr int kStates = 4;
  static constexpr int kMeasurements = 2;
  using State = Eigen::Matrix<Scalar, kStates, 1>;
  using Vector = Eigen::Matrix<Scalar, kMeasurements, 1>;
  using Jacobian = Eigen::Matrix<Scalar, kMeasurements, kStates>;
  using Covariance = Eigen::Matrix<Scalar, kMeasurements, kMeasurements>;

  Vector site_m;  ///< East, North
  Scalar sigma_range_m;
  Scalar sigma_bearing_rad;

  /// Bearings in [-pi, pi].
  Vector h(const State& x) const {
    const Vector offset_m = x.template head<2>() - site_m;
    return Vector(offset_m.norm(), std::atan2(offset_m.x(), offset_m.y()));
  }

  /// At the site itself neither range nor bearing has a derivative; H is zero there, so that the measurement leaves the
  /// state alone.
  Jacobian H(const State& x) const {
    const Vector offset_m = x.template head<2>() - site_m;
    const Scalar range_m = offset_m.norm();
    const Scalar inverse_range = range_m > 0 ? 1 / range_m : Scalar(0);
    const Vector u = offset_m * inverse_range;
    Jacobian jacobian = Jacobian::Zero();
    jacobian(0, 0) = u.x();
    jacobian(0, 1) = u.y();
    jacobian(1, 0) = u.y() * inverse_range;
    jacobian(1, 1) = -u.x() * inverse_range;
    return jacobian;
  }

  Covariance R() const {
    return Covariance(Vector(sigma_range_m * sigma_range_m, sigma_bearing_rad * sigma_bearing_rad).asDiagonal());
  }

  /// The bearing's component in [-pi, pi].
  Vector residual(const Vector& z, const Vector& z_pred) const {
    return Vector(z(0) - z_pred(0), static_cast<Scalar>(wrap_pi(z(1) - z_pred(1))));
  }

  /// residual(h(x_i), z_0) of many states (2 x count, by columns), x_i at X + i stride.
  void residuals_of(const double* X, int stride, int count, const Vector& z_0,
                    double* residuals) const requires std::is_same_v<Scalar, double> {
    range_bearing_residuals(X, stride, count, site_m.data(), z_0.data(), residuals);
  }
};

static_assert(MeasurementModel<RangeBearing<>>);
static_assert(MeasurementModel<RangeBearing<float>>);

struct ConvertedPosition {
  Eigen::Vector2d position_m;  ///< East, North
  Eigen::Matrix2d R_m2;        ///< mean square of its error (2 x 2), given the measurement
};

/// z = [range_m, bearing_rad] seen from site_m as a position whose error has mean zero: the factor exp(sigma_b^2 / 2)
/// is for what the spread of the bearing takes from the mean. R is the paper's, written along and across the line of
/// sight: the same matrix without the differences of nearly equal terms of the size range^2.
inline ConvertedPosition convert_range_bearing(const Eigen::Vector2d& z, double sigma_range_m, double sigma_bearing_rad,
                                               const Eigen::Vector2d& site_m) {
  const double range2 = z(0) * z(0), range_variance = sigma_range_m * sigma_range_m;
  const double bearing_variance = sigma_bearing_rad * sigma_bearing_rad;
  const Eigen::Vector2d along(std::sin(z(1)), std::cos(z(1))), across(along.y(), -along.x());
  // e = exp(-sigma_b^2) - 1, so that E cos(2 b) = 1 + e (e + 2) for the bearing's error b.
  const double e = std::expm1(-bearing_variance);
  const double half_loss = -0.5 * e * (e + 2.0);
  const double along_variance = range_variance * (1.0 - half_loss) + range2 * e * e * (e + 3.0) / (2.0 * (1.0 + e));
  const double across_variance = (range2 + range_variance) * half_loss;
  ConvertedPosition converted;
  converted.position_m = site_m + std::exp(0.5 * bearing_variance) * z(0) * along;
  converted.R_m2 = along_variance * along * along.transpose() + across_variance * across * across.transpose();
  return converted;
}

/// R of a converted position (2 x 2), given where the target is, offset_m (2) from the site. A filter that knows that
/// better than one measurement tells it must not take R from the measurement: it would lie along the bearing as it was
/// measured, so that gain and error go together and every range comes out longer than it is.
inline Eigen::Matrix2d converted_covariance(const Eigen::Vector2d& offset_m, double sigma_range_m,
                                            double sigma_bearing_rad) {
  const double range2 = offset_m.squaredNorm(), range_variance = sigma_range_m * sigma_range_m;
  const Eigen::Vector2d along =
      range2 > 0.0 ? Eigen::Vector2d(offset_m / std::sqrt(range2)) : Eigen::Vector2d(0.0, 1.0);
  const Eigen::Vector2d across(along.y(), -along.x());
  const double e = std::expm1(-sigma_bearing_rad * sigma_bearing_rad);
  const double half_loss = -0.5 * e * (e + 2.0);
  const double along_variance = (0.5 * range2 * e * e + range_variance * (1.0 - half_loss)) / (1.0 + e);
  const double across_variance = (range2 + range_variance) * half_loss / (1.0 + e);
  return along_variance * along * along.transpose() + across_variance * across * across.transpose();
}

}  // namespace truebearing
