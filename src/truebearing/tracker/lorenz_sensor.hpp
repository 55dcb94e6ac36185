// SPDX-License-Identifier: Apache-2.0
// A sensor of the three components of the Lorenz attractor, as a matrix turns or mixes them (any_sensor.hpp). The
// measurement's own standard deviations hold where it carries them, else `sigma`; either is multiplied by sigma_factor.
#pragma once

#include <Eigen/Core>

#include "truebearing/measurement/linear.hpp"
#include "truebearing/measurement/measured.hpp"
#include "truebearing/measurement/measurement.hpp"

namespace truebearing {

struct LorenzSensor {
  using Model = Linear<3, 3>;
  static constexpr bool kMeasuresPosition = false;

  Eigen::Matrix3d matrix = Eigen::Matrix3d::Identity();  ///< H
  Eigen::Vector3d sigma = Eigen::Vector3d::Ones();
  double sigma_factor = 1.0;

  Model model(const Measurement& measurement) const {
    return {matrix, measurement.sigma.size() == 3 ? Eigen::Vector3d(sigma_factor * measurement.sigma)
                                                  : Eigen::Vector3d(sigma_factor * sigma)};
  }
  Eigen::Vector3d value(const Measurement& measurement) const { return measurement.z; }
  Measured measured() const { return Measured::lorenz(); }
};

}  // namespace truebearing
