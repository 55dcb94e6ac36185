// SPDX-License-Identifier: Apache-2.0
// A sensor of bearings (any_sensor.hpp): where the measurement says that its sensor was, at the origin
// and at rest where it does not say. A frequency behind the bearing is left alone. The measurement's own standard
// deviation holds where it carries one, else the sensor's; either is multiplied by sigma_factor.
#pragma once

#include <cmath>
#include <optional>

#include "truebearing/measurement/bearing.hpp"
#include "truebearing/measurement/measured.hpp"
#include "truebearing/measurement/measurement.hpp"
#include "truebearing/tma/range_prior.hpp"
#include "truebearing/tracker/any_sensor.hpp"

namespace truebearing {

struct BearingSensor {
  using Model = Bearing<>;
  static constexpr bool kMeasuresPosition = false;

  double sigma_rad = 1.0;
  double sigma_factor = 1.0;

  Model model(const Measurement& measurement) const {
    const SensorState sensor = measurement.sensor.value_or(SensorState{});
    const double sigma = measurement.sigma.size() > 0 ? measurement.sigma[0] : sigma_rad;
    return {sensor.position_m, sensor.velocity_mps, sigma_factor * sigma};
  }
  bool has_value(const Measurement& measurement) const {
    return (measurement.z.size() == 1 || measurement.z.size() == 2) && std::isfinite(measurement.z[0]);
  }
  Model::Vector value(const Measurement& measurement) const { return measurement.z.head<1>(); }
  Measured measured() const { return Measured::bearing(); }
  Sight sight(const Measurement& measurement) const {
    const Model model = this->model(measurement);
    return {measurement.z[0], model.sigma_rad, {model.site_m, model.site_velocity_mps}};
  }
  /// What is believed of the plane is all that it needs.
  std::optional<PriorStart> believe(const GaussianState& plane, const Measurement&) const {
    return PriorStart{plane.x, plane.P};
  }
};

}  // namespace truebearing
