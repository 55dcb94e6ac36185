// SPDX-License-Identifier: Apache-2.0
// A Doppler radar's sensor: range, bearing and range rate (any_sensor.hpp), where the measurement says that it was, else
// at site_m and at rest. The measurement's own standard deviations hold where it carries them, else the sensor's; either
// is multiplied by sigma_factor.
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "truebearing/measurement/measured.hpp"
#include "truebearing/measurement/measurement.hpp"
#include "truebearing/measurement/range_bearing_rate.hpp"
#include "truebearing/measurement/range_rate_curvature.hpp"
#include "truebearing/tracker/start.hpp"
#include "truebearing/tracker/step_record.hpp"

namespace truebearing {

struct RangeBearingRateSensor {
  using Model = RangeBearingRate<>;
  static constexpr bool kMeasuresPosition = false;

  Eigen::Vector3d sigma{1.0, 1.0, 1.0};  ///< m, rad, m/s
  double sigma_factor = 1.0;
  Eigen::Vector2d site_m = Eigen::Vector2d::Zero();
  double correlation = 0.0;  ///< of range and range rate

  Model model(const Measurement& measurement) const {
    const SensorState from = measurement.sensor.value_or(SensorState{site_m, Eigen::Vector2d::Zero()});
    const Eigen::Vector3d s =
        sigma_factor * (measurement.sigma.size() == 3 ? Eigen::Vector3d(measurement.sigma) : sigma);
    return {from.position_m, from.velocity_mps, s[0], s[1], s[2], correlation};
  }
  Model::Vector value(const Measurement& measurement) const { return measurement.z; }
  Measured measured() const { return Model::measured(); }
  /// Range and bearing, converted without bias; the range rate tells no velocity across.
  PositionFix fix(const Measurement& measurement) const {
    const Model here = model(measurement);
    const ConvertedPosition converted =
        convert_range_bearing(measurement.z.head<2>(), here.sigma_range_m, here.sigma_bearing_rad, here.site_m);
    return {converted.position_m, converted.R_m2};
  }
};

/// The same for extended filters, with the second order of the range rate about what is expected
/// (range_rate_curvature.hpp).
struct SecondOrderRateSensor {
  struct Model : RangeBearingRate<> {
    double curvature_mps = 0.0;

    Vector h(const State& x) const {
      Vector z = RangeBearingRate<>::h(x);
      z[2] += curvature_mps;
      return z;
    }
  };
  static constexpr bool kMeasuresPosition = false;

  RangeBearingRateSensor polar;

  Model model(const Measurement& measurement, const Prediction& expected) const {
    RangeBearingRate<> seen = polar.model(measurement);
    const RangeRateCurvature curvature =
        range_rate_curvature(seen, expected.x.head<4>(), expected.P.topLeftCorner<4, 4>());
    const double sigma_mps = std::sqrt(seen.sigma_rate_mps * seen.sigma_rate_mps + curvature.variance_m2ps2);
    seen.correlation *= seen.sigma_rate_mps / sigma_mps;  // what is added has nothing in common with the range
    seen.sigma_rate_mps = sigma_mps;
    return {seen, curvature.mean_mps};
  }
  Model::Vector value(const Measurement& measurement) const { return measurement.z; }
  Measured measured() const { return polar.measured(); }
  PositionFix fix(const Measurement& measurement) const { return polar.fix(measurement); }
};

}  // namespace truebearing
