// A sensor of bearings, as the FilterTracker wants it: where the measurement says that its sensor was, at the origin
// and at rest where it does not say. The measurement's own standard deviation holds where it carries one, else the
// sensor's; either is multiplied by sigma_factor.
#pragma once

#include "truebearing/measurement/bearing.hpp"
#include "truebearing/measurement/measurement.hpp"

namespace truebearing {

struct BearingSensor {
  using Model = Bearing<>;
  static constexpr bool kMeasuresPosition = false;

  double sigma_rad = 1.0;
  double sigma_factor = 1.0;

  Model model(const Measurement& measurement) const {
    const SensorState sensor = measurement.sensor.value_or(SensorState{});
    const double sigma = measurement.sigma.size() == 1 ? measurement.sigma[0] : sigma_rad;
    return {sensor.position_m, sensor.velocity_mps, sigma_factor * sigma};
  }
  Model::Vector value(const Measurement& measurement) const { return measurement.z; }
};

}  // namespace truebearing
