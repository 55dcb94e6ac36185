// SPDX-License-Identifier: Apache-2.0
// A sensor of position and velocity on a line (any_sensor.hpp). The measurement's own standard deviations hold where it
// carries them, else the sensor's; either is multiplied by sigma_factor.
#pragma once

#include "truebearing/measurement/linear.hpp"
#include "truebearing/measurement/measured.hpp"
#include "truebearing/measurement/measurement.hpp"
#include "truebearing/tracker/start.hpp"

namespace truebearing {

struct PositionVelocitySensor {
  using Model = Linear<2, 2>;
  static constexpr bool kMeasuresPosition = false;

  Eigen::Vector2d sigma{1.0, 1.0};  ///< m, m/s
  double sigma_factor = 1.0;

  Model model(const Measurement& measurement) const {
    return {Eigen::Matrix2d::Identity(),
            sigma_factor * (measurement.sigma.size() == 2 ? Eigen::Vector2d(measurement.sigma) : sigma)};
  }
  Model::Vector value(const Measurement& measurement) const { return measurement.z; }
  Measured measured() const { return Measured::position_velocity(); }
  /// Its position alone.
  PositionFix fix(const Measurement& measurement) const {
    return {measurement.z.head(1), model(measurement).R().topLeftCorner(1, 1)};
  }
};

}  // namespace truebearing
