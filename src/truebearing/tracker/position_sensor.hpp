// SPDX-License-Identifier: Apache-2.0
// A sensor of positions (any_sensor.hpp).
#pragma once

#include "truebearing/measurement/measured.hpp"
#include "truebearing/measurement/measurement.hpp"
#include "truebearing/measurement/position.hpp"
#include "truebearing/tracker/start.hpp"

namespace truebearing {

/// Measures the position components. The measurement's own standard deviations hold where it carries them and `reported`
/// says so, else `sigma_m`; either is multiplied by `sigma_factor`.
template <int D>
struct PositionSensor {
  using Model = Position<D>;
  using Sigma = Eigen::Matrix<double, D, 1>;
  static constexpr bool kMeasuresPosition = true;

  Sigma sigma_m = Sigma::Ones();
  double sigma_factor = 1.0;
  bool reported = true;

  Model model(const Measurement& measurement) const {
    const bool is_told = reported && measurement.sigma.size() == D;
    return Model{sigma_factor * (is_told ? Sigma(measurement.sigma) : sigma_m)};
  }
  Sigma value(const Measurement& measurement) const { return measurement.z; }
  Measured measured() const { return Measured::position(D); }
  PositionFix fix(const Measurement& measurement) const { return {value(measurement), model(measurement).R()}; }
};

}  // namespace truebearing
