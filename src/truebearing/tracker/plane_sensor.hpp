// Sensors of a target in the plane [east, north, v_east, v_north] (any_sensor.hpp). The measurement's
// own standard deviations hold where it carries them, else the sensor's; either is multiplied by sigma_factor.
#pragma once

#include <Eigen/Core>

#include "truebearing/measurement/cartesian_position.hpp"
#include "truebearing/measurement/measured.hpp"
#include "truebearing/measurement/measurement.hpp"
#include "truebearing/measurement/range_bearing.hpp"
#include "truebearing/tracker/start.hpp"

namespace truebearing {

/// Measures the position: directly, z = [east_m, north_m], or as z = [range_m, bearing_rad] from a site, which is
/// converted (unbiased) to a position with the covariance that belongs to it.
struct PlaneSensor {
  using Model = CartesianPosition<2>;
  static constexpr bool kMeasuresPosition = true;

  Eigen::Vector2d sigma{1.0, 1.0};  ///< m, m; or m, rad
  double sigma_factor = 1.0;
  bool is_polar = false;
  Eigen::Vector2d site_m = Eigen::Vector2d::Zero();  ///< where a measurement does not say where its sensor was

  Model model(const Measurement& measurement) const {
    if (is_polar) return {converted(measurement).R_m2};
    return {Eigen::Matrix2d(scaled(measurement).cwiseAbs2().asDiagonal())};
  }
  Eigen::Vector2d value(const Measurement& measurement) const {
    return is_polar ? converted(measurement).position_m : Eigen::Vector2d(measurement.z);
  }
  Measured measured() const { return is_polar ? Measured::range_bearing() : Measured::position(2); }
  PositionFix fix(const Measurement& measurement) const { return {value(measurement), model(measurement).R()}; }

 private:
  Eigen::Vector2d scaled(const Measurement& measurement) const {
    return measurement.sigma.size() == 2 ? Eigen::Vector2d(sigma_factor * measurement.sigma)
                                         : Eigen::Vector2d(sigma_factor * sigma);
  }
  ConvertedPosition converted(const Measurement& measurement) const {
    const Eigen::Vector2d s = scaled(measurement);
    return convert_range_bearing(Eigen::Vector2d(measurement.z), s[0], s[1],
                                 measurement.sensor ? measurement.sensor->position_m : site_m);
  }
};

/// Range and bearing as they are, for filters that linearise or transform.
struct PolarSensor {
  using Model = RangeBearing<>;
  static constexpr bool kMeasuresPosition = false;

  Eigen::Vector2d sigma{1.0, 1.0};  ///< m, rad
  double sigma_factor = 1.0;
  Eigen::Vector2d site_m = Eigen::Vector2d::Zero();

  Model model(const Measurement& measurement) const {
    const Eigen::Vector2d s =
        sigma_factor * (measurement.sigma.size() == 2 ? Eigen::Vector2d(measurement.sigma) : sigma);
    return {measurement.sensor ? measurement.sensor->position_m : site_m, s[0], s[1]};
  }
  Eigen::Vector2d value(const Measurement& measurement) const { return measurement.z; }
  Measured measured() const { return Measured::range_bearing(); }
  /// Converted, as PlaneSensor does.
  PositionFix fix(const Measurement& measurement) const {
    return PlaneSensor{sigma, sigma_factor, true, site_m}.fix(measurement);
  }
};

}  // namespace truebearing
