// SPDX-License-Identifier: Apache-2.0
// Sensors of range and bearing, z = [range_m, bearing_rad], of a target in the plane [east, north, v_east, v_north]
// (any_sensor.hpp). A range rate behind the two is left alone. The measurement's own standard deviations hold where it
// carries them, else the sensor's; either is multiplied by sigma_factor.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "truebearing/measurement/cartesian_position.hpp"
#include "truebearing/measurement/measured.hpp"
#include "truebearing/measurement/measurement.hpp"
#include "truebearing/measurement/range_bearing.hpp"
#include "truebearing/tracker/first_components.hpp"
#include "truebearing/tracker/start.hpp"
#include "truebearing/tracker/step_record.hpp"

namespace truebearing {

/// Range and bearing as they are, for filters that linearise or transform.
struct PolarSensor {
  using Model = RangeBearing<>;
  static constexpr bool kMeasuresPosition = false;

  Eigen::Vector2d sigma{1.0, 1.0};  ///< m, rad
  double sigma_factor = 1.0;
  Eigen::Vector2d site_m = Eigen::Vector2d::Zero();  ///< where a measurement does not say where its sensor was

  Model model(const Measurement& measurement) const {
    const Eigen::Vector2d s =
        sigma_factor * (measurement.sigma.size() >= 2 ? Eigen::Vector2d(measurement.sigma.head<2>()) : sigma);
    return {measurement.sensor ? measurement.sensor->position_m : site_m, s[0], s[1]};
  }
  bool has_value(const Measurement& measurement) const { return has_first(measurement, 2); }
  Eigen::Vector2d value(const Measurement& measurement) const { return measurement.z.head<2>(); }
  Measured measured() const { return Measured::range_bearing(); }
  ConvertedPosition converted(const Measurement& measurement) const {
    const Model polar = model(measurement);
    return convert_range_bearing(value(measurement), polar.sigma_range_m, polar.sigma_bearing_rad, polar.site_m);
  }
  PositionFix fix(const Measurement& measurement) const {
    const ConvertedPosition position = converted(measurement);
    return {position.position_m, position.R_m2};
  }
};

/// R (2 x 2) of a measured range and bearing that is converted to a position: that of the expected place where it is known
/// better across the sight than the measurement tells it, else that of the measured one, which measured_R_m2() gives.
template <typename MeasuredR>
Eigen::Matrix2d converted_R_m2(const RangeBearing<>& seen, const Prediction& expected, const MeasuredR& measured_R_m2) {
  const Eigen::Vector2d offset_m = expected.x.head<2>() - seen.site_m;
  const Eigen::Matrix2d R = converted_covariance(offset_m, seen.sigma_range_m, seen.sigma_bearing_rad);
  const Eigen::Vector2d across(offset_m.y(), -offset_m.x());
  const bool is_known = across.dot(expected.P.topLeftCorner<2, 2>() * across) < across.dot(R * across);
  return is_known ? R : Eigen::Matrix2d(measured_R_m2());
}

/// Range and bearing converted (unbiased) to a position.
struct ConvertedSensor {
  using Model = CartesianPosition<2>;
  static constexpr bool kMeasuresPosition = true;

  PolarSensor polar;
  /// Where given, R is this squared in both axes, wherever the target is: of filters that are told x and y and no more.
  std::optional<double> position_sigma_m = std::nullopt;

  Model model(const Measurement& measurement, const Prediction& expected) const {
    if (position_sigma_m) return {one_R_m2()};
    return {converted_R_m2(polar.model(measurement), expected, [&] { return polar.converted(measurement).R_m2; })};
  }
  bool has_value(const Measurement& measurement) const { return polar.has_value(measurement); }
  Eigen::Vector2d value(const Measurement& measurement) const { return polar.converted(measurement).position_m; }
  Measured measured() const { return Measured::range_bearing(); }
  PositionFix fix(const Measurement& measurement) const {
    PositionFix fix = polar.fix(measurement);
    if (position_sigma_m) fix.R = one_R_m2();
    return fix;
  }

 private:
  Eigen::Matrix2d one_R_m2() const { return *position_sigma_m * *position_sigma_m * Eigen::Matrix2d::Identity(); }
};

}  // namespace truebearing
