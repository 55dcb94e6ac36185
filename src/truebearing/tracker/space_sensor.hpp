// SPDX-License-Identifier: Apache-2.0
// Sensors of targets in space [east, north, up, v_east, v_north, v_up] (any_sensor.hpp): range, bearing and elevation,
// with a range rate or without, as they are or converted, and bearing and elevation alone. Where the measurement says
// that its sensor was, at the height of site_m where it tells none (NaN); else at site_m and at rest. The measurement's own standard deviations hold where it carries them,
// else the sensor's; either is multiplied by sigma_factor.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <optional>

#include "truebearing/measurement/bearing_elevation.hpp"
#include "truebearing/measurement/cartesian_position.hpp"
#include "truebearing/measurement/measurement.hpp"
#include "truebearing/measurement/position_and_rate.hpp"
#include "truebearing/measurement/range_bearing_elevation_rate.hpp"
#include "truebearing/tracker/any_sensor.hpp"
#include "truebearing/tracker/first_components.hpp"
#include "truebearing/tracker/start.hpp"

namespace truebearing {

/// Where a sensor is and how well it measures: `M` standard deviations.
template <int M>
struct SpaceSite {
  using Sigma = Eigen::Matrix<double, M, 1>;

  Sigma sigma = Sigma::Ones();  ///< m, rad, rad, m/s, or as many of them as are measured
  double sigma_factor = 1.0;
  Eigen::Vector3d site_m = Eigen::Vector3d::Zero();

  Sigma sigma_of(const Measurement& measurement) const {
    return sigma_factor * (measurement.sigma.size() >= M ? Sigma(measurement.sigma.template head<M>()) : sigma);
  }
  Eigen::Vector3d place(const Measurement& measurement) const {
    if (!measurement.sensor) return site_m;
    const SensorState& sensor = *measurement.sensor;
    return {sensor.position_m.x(), sensor.position_m.y(), std::isnan(sensor.up_m) ? site_m.z() : sensor.up_m};
  }
  Eigen::Vector3d velocity(const Measurement& measurement) const {
    if (!measurement.sensor) return Eigen::Vector3d::Zero();
    return {measurement.sensor->velocity_mps.x(), measurement.sensor->velocity_mps.y(), measurement.sensor->climb_mps};
  }

  /// Range, bearing and elevation converted to a position, with the covariance of a target there.
  PositionFix converted(const Measurement& measurement) const requires(M >= 3) {
    const Eigen::Vector3d s = sigma_of(measurement).template head<3>(), from = place(measurement);
    const Eigen::Vector3d position = convert_range_bearing_elevation(measurement.z.template head<3>(), s, from);
    return {position, converted_covariance(position - from, s)};
  }

  /// The covariance of a converted position to a track that expects its target there: that of the expected place where
  /// it is known better than the measurement tells it, else that of the measured one (range_bearing.hpp says why).
  Eigen::Matrix3d converted_R(const Measurement& measurement, const Prediction& expected) const requires(M >= 3) {
    const Eigen::Vector3d offset_m = expected.x.template head<3>() - place(measurement);
    const Eigen::Matrix3d R = converted_covariance(offset_m, sigma_of(measurement).template head<3>());
    const bool is_known = expected.P.template topLeftCorner<3, 3>().trace() < R.trace();
    return is_known ? R : Eigen::Matrix3d(converted(measurement).R);
  }
};

/// A range rate behind the three is left alone.
struct RangeBearingElevationSensor {
  using Model = RangeBearingElevation<>;
  static constexpr bool kMeasuresPosition = false;

  SpaceSite<3> site;

  Model model(const Measurement& measurement) const { return {site.place(measurement), site.sigma_of(measurement)}; }
  bool has_value(const Measurement& measurement) const { return has_first(measurement, 3); }
  Model::Vector value(const Measurement& measurement) const { return measurement.z.head<3>(); }
  Measured measured() const { return Model::measured(); }
  PositionFix fix(const Measurement& measurement) const { return site.converted(measurement); }
};

/// The same, converted to a position.
struct ConvertedElevationSensor {
  using Model = CartesianPosition<3>;
  static constexpr bool kMeasuresPosition = true;

  SpaceSite<3> site;

  Model model(const Measurement& measurement, const Prediction& expected) const {
    return {site.converted_R(measurement, expected)};
  }
  bool has_value(const Measurement& measurement) const { return has_first(measurement, 3); }
  Model::Vector value(const Measurement& measurement) const { return site.converted(measurement).z; }
  Measured measured() const { return RangeBearingElevation<>::measured(); }
  PositionFix fix(const Measurement& measurement) const { return site.converted(measurement); }
};

struct RangeBearingElevationRateSensor {
  using Model = RangeBearingElevationRate<>;
  static constexpr bool kMeasuresPosition = false;

  SpaceSite<4> site;
  double correlation = 0.0;  ///< of range and range rate

  Model model(const Measurement& measurement) const {
    return {site.place(measurement), site.velocity(measurement), site.sigma_of(measurement), correlation};
  }
  Model::Vector value(const Measurement& measurement) const { return measurement.z; }
  Measured measured() const { return Model::measured(); }
  PositionFix fix(const Measurement& measurement) const { return site.converted(measurement); }
};

/// The same, converted to a position, and to a speed along the direction in which the target is measured, from which
/// what its error has in common with the range's is taken (range_rate_sensor.hpp).
struct ConvertedElevationRateSensor {
  using Model = PositionAndRate<3>;
  static constexpr bool kMeasuresPosition = false;

  SpaceSite<4> site;
  double correlation = 0.0;

  Model model(const Measurement& measurement, const Prediction& expected) const {
    const double sigma_rate_mps = site.sigma_of(measurement)[3] * std::sqrt(1.0 - correlation * correlation);
    const Eigen::Vector3d u = along(measurement);
    Model::State row;
    row << -range_share(measurement) * u, u;
    return {site.converted_R(measurement, expected), row, 0.0, sigma_rate_mps};
  }
  /// The speed as if the sensor were at rest at the origin.
  Model::Vector value(const Measurement& measurement) const {
    const Eigen::Vector3d u = along(measurement);
    const double c = range_share(measurement);
    Model::Vector z;
    z << site.converted(measurement).z,
        measurement.z[3] + u.dot(site.velocity(measurement)) - c * (measurement.z[0] + u.dot(site.place(measurement)));
    return z;
  }
  Measured measured() const { return RangeBearingElevationRate<>::measured(); }
  PositionFix fix(const Measurement& measurement) const { return site.converted(measurement); }

 private:
  static Eigen::Vector3d along(const Measurement& measurement) {
    const double bearing = measurement.z[1], elevation = measurement.z[2], level = std::cos(elevation);
    return {level * std::sin(bearing), level * std::cos(bearing), std::sin(elevation)};
  }
  double range_share(const Measurement& measurement) const {
    const SpaceSite<4>::Sigma s = site.sigma_of(measurement);
    return correlation * s[3] / s[0];
  }
};

/// Two angles tell a direction: their tracks begin with what is believed of the range.
struct BearingElevationSensor {
  using Model = BearingElevation<>;
  static constexpr bool kMeasuresPosition = false;

  SpaceSite<2> site;

  Model model(const Measurement& measurement) const { return {site.place(measurement), site.sigma_of(measurement)}; }
  Model::Vector value(const Measurement& measurement) const { return measurement.z; }
  Measured measured() const { return Model::measured(); }
  Sight sight(const Measurement& measurement) const {
    const Eigen::Vector3d place = site.place(measurement), velocity = site.velocity(measurement);
    return {
        measurement.z[0], site.sigma_of(measurement)[0], {place.head<2>(), velocity.head<2>(), place[2], velocity[2]}};
  }
  /// The range that is believed in is the one along the ground; height follows from it and the elevation, and what is
  /// believed of the climb is as uncertain as the velocity in the plane.
  std::optional<PriorStart> believe(const GaussianState& plane, const Measurement& measurement) const {
    const Eigen::Vector3d from = site.place(measurement);
    const Eigen::Vector2d offset_m = plane.x.head<2>() - from.head<2>();
    const double ground_m = offset_m.norm(), tangent = std::tan(measurement.z[1]);
    const double height_sigma_m = ground_m * (1.0 + tangent * tangent) * site.sigma_of(measurement)[1];
    Eigen::Matrix<double, 6, 4> G = Eigen::Matrix<double, 6, 4>::Zero();  // d state / d plane
    G(0, 0) = G(1, 1) = G(3, 2) = G(4, 3) = 1.0;
    if (ground_m > 0.0) G.block<1, 2>(2, 0) = tangent / ground_m * offset_m.transpose();
    PriorStart start{BoundedVector(G * plane.x), BoundedMatrix(G * plane.P * G.transpose())};
    start.x[2] = from[2] + ground_m * tangent;
    start.P(2, 2) += height_sigma_m * height_sigma_m;
    start.P(5, 5) = 0.5 * (plane.P(2, 2) + plane.P(3, 3));
    return start;
  }
};

}  // namespace truebearing
