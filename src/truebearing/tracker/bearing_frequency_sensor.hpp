// SPDX-License-Identifier: Apache-2.0
// A sensor of bearings and Doppler-shifted frequencies, (any_sensor.hpp): where the measurement says that
// its sensor was. z = [bearing_rad, frequency_hz], either missing, or the bearing alone. The measurement's own standard
// deviations hold where it carries them, else the sensor's; either is multiplied by sigma_factor.
#pragma once

#include <cmath>
#include <limits>
#include <optional>

#include "truebearing/measurement/bearing_frequency.hpp"
#include "truebearing/measurement/measured.hpp"
#include "truebearing/measurement/measurement.hpp"
#include "truebearing/tma/range_prior.hpp"
#include "truebearing/tracker/any_sensor.hpp"

namespace truebearing {

struct BearingFrequencySensor {
  using Model = BearingFrequency<>;
  static constexpr bool kMeasuresPosition = false;

  double sigma_rad = 1.0;
  double sigma_hz = 1.0;
  double sigma_factor = 1.0;
  double sound_mps = kSoundInWater_mps;

  bool has_value(const Measurement& measurement) const {
    const Model::Vector z = value(measurement);
    return std::isfinite(z(0)) || std::isfinite(z(1));
  }

  Model model(const Measurement& measurement) const {
    const SensorState sensor = measurement.sensor.value_or(SensorState{});
    const Model::Vector z = value(measurement);
    const bool own = measurement.sigma.size() > 0;
    return {sensor.position_m,
            sensor.velocity_mps,
            sigma_factor * (own ? measurement.sigma[0] : sigma_rad),
            sigma_factor * (measurement.sigma.size() > 1 ? measurement.sigma[1] : sigma_hz),
            sound_mps,
            std::isfinite(z(0)),
            std::isfinite(z(1))};
  }

  /// NaN in place of what is missing, and of a frequency that no source has.
  Model::Vector value(const Measurement& measurement) const {
    constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();
    Model::Vector z = Model::Vector::Constant(kMissing);
    if (measurement.z.size() == 1 || measurement.z.size() == 2) z.head(measurement.z.size()) = measurement.z;
    if (z(1) <= 0.0) z(1) = kMissing;
    return z;
  }

  Measured measured() const { return Measured::bearing_frequency(); }
  Sight sight(const Measurement& measurement) const {
    const Model model = this->model(measurement);
    return {value(measurement)[0], model.sigma_rad, {model.site_m, model.site_velocity_mps}};
  }

  /// What is believed of the plane with the frequency that the measurement lets one believe in:
  /// f0 = f (1 + v_r / c), as uncertain as f and, together with the velocity, as v_r. Nothing where it has no
  /// frequency.
  std::optional<PriorStart> believe(const GaussianState& plane, const Measurement& measurement) const {
    const Model model = this->model(measurement);
    if (!model.has_bearing || !model.has_frequency) return std::nullopt;
    const Model::Vector z = value(measurement);
    const Eigen::Vector2d u(std::sin(z(0)), std::cos(z(0)));
    const double per_mps = z(1) / sound_mps;
    Eigen::Matrix<double, 5, 4> T = Eigen::Matrix<double, 5, 4>::Identity();
    T.block<1, 2>(4, 2) = per_mps * u.transpose();
    Eigen::Matrix<double, 5, 1> x;
    x << plane.x, z(1) + per_mps * u.dot(plane.x.tail<2>() - model.site_velocity_mps);
    Eigen::Matrix<double, 5, 5> P = T * plane.P * T.transpose();
    P(4, 4) += model.sigma_hz * model.sigma_hz;
    return PriorStart{x, P};
  }
};

}  // namespace truebearing
