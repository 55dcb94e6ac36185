// SPDX-License-Identifier: Apache-2.0
// Sensors of a range rate in the plane without a bearing, alone or with a range (any_sensor.hpp), and a Doppler radar's
// range, bearing and range rate, converted. Where the measurement says that the sensor was, else at site_m and at rest.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cmath>

#include "truebearing/measurement/position_and_rate.hpp"
#include "truebearing/measurement/range_rate.hpp"
#include "truebearing/measurement/range_rate_curvature.hpp"
#include "truebearing/tracker/polar_sensor.hpp"
#include "truebearing/tracker/range_bearing_rate_sensor.hpp"
#include "truebearing/tracker/step_record.hpp"

namespace truebearing {

/// PartialModel: RangeRate or RangeAndRate.
template <typename PartialModel>
struct PartialRangeRateSensor {
  using Model = PartialModel;
  using Sigma = typename Model::Vector;
  static constexpr bool kMeasuresPosition = false;

  Sigma sigma = Sigma::Ones();  ///< m, m/s
  double sigma_factor = 1.0;
  Eigen::Vector2d site_m = Eigen::Vector2d::Zero();
  double correlation = 0.0;  ///< of range and range rate

  Model model(const Measurement& measurement) const {
    constexpr int kLast = Model::kMeasurements - 1;
    const SensorState from = measurement.sensor.value_or(SensorState{site_m, Eigen::Vector2d::Zero()});
    const Sigma s = sigma_factor * (measurement.sigma.size() == kLast + 1 ? Sigma(measurement.sigma) : sigma);
    return {{{from.position_m, from.velocity_mps, s[0], 1.0, s[kLast], kLast > 0 ? correlation : 0.0}}};
  }
  typename Model::Vector value(const Measurement& measurement) const { return measurement.z; }
  Measured measured() const { return Model::measured(); }
};

/// The unbiased converted position first, then the range rate, linearised about the estimate that the position leaves:
/// that is one update with both, whose R is block diagonal. What the range's error has in common with the range rate's
/// is taken out of it: rate - c range with c = rho sigma_rate / sigma_range. Bar-Shalom, Li and Kirubarajan 2001, section
/// 10.4.3, for the conversion; Duan, Li, Han and Zhu 2005 for the order. Where it is asked for, with the second order of
/// the range rate about that estimate (range_rate_curvature.hpp).
struct ConvertedRateSensor {
  using Model = PositionAndRate<2>;
  static constexpr bool kMeasuresPosition = false;

  RangeBearingRateSensor polar;
  bool second_order = false;

  Model model(const Measurement& measurement, const Prediction& expected) const {
    const RangeBearingRate<> seen = polar.model(measurement);
    const PositionFix fix = polar.fix(measurement);
    const RangeBearing<> place{seen.site_m, seen.sigma_range_m, seen.sigma_bearing_rad};
    const Eigen::Matrix2d R = converted_R_m2(place, expected, [&] { return fix.R; });
    const Estimate between = after_position(fix.z, R, expected);
    const Eigen::Vector4d& x = between.x;
    const Eigen::Vector3d z = seen.h(x);
    const Eigen::Matrix<double, 3, 4> H = seen.H(x);
    const double c = range_share(seen), rho = seen.correlation;
    const Eigen::Vector4d row = (H.row(2) - c * H.row(0)).transpose();
    const RangeRateCurvature curvature = second_order ? range_rate_curvature(seen, x, between.P) : RangeRateCurvature();
    const double variance = seen.sigma_rate_mps * seen.sigma_rate_mps * (1.0 - rho * rho) + curvature.variance_m2ps2;
    return {R, row, z[2] - c * z[0] - row.dot(x) + curvature.mean_mps, std::sqrt(variance)};
  }
  Model::Vector value(const Measurement& measurement) const {
    const double c = range_share(polar.model(measurement));
    Model::Vector z;
    z << polar.fix(measurement).z, measurement.z[2] - c * measurement.z[0];
    return z;
  }
  Measured measured() const { return polar.measured(); }
  PositionFix fix(const Measurement& measurement) const { return polar.fix(measurement); }

 private:
  static double range_share(const RangeBearingRate<>& seen) {
    return seen.correlation * seen.sigma_rate_mps / seen.sigma_range_m;
  }

  struct Estimate {
    Eigen::Vector4d x;
    Eigen::Matrix4d P;
  };

  // The position's update of what is expected; where S is no covariance, what is expected.
  static Estimate after_position(const Eigen::Vector2d& z, const Eigen::Matrix2d& R, const Prediction& expected) {
    Estimate estimate{expected.x.head<4>(), expected.P.topLeftCorner<4, 4>()};
    const Eigen::Matrix<double, 4, 2> PH = estimate.P.leftCols<2>();
    const Eigen::Matrix2d S = PH.topRows<2>() + R;
    const Eigen::LLT<Eigen::Matrix2d> root(S);
    if (root.info() != Eigen::Success) return estimate;
    estimate.x += PH * root.solve(z - estimate.x.head<2>());
    estimate.P -= PH * root.solve(PH.transpose());
    return estimate;
  }
};

}  // namespace truebearing
