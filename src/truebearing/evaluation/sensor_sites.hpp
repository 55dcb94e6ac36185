// SPDX-License-Identifier: Apache-2.0
// Where the sensors of a study stand, for who looks at measurements from outside the trackers: to foretell and to draw.
#pragma once

#include <cmath>
#include <cstddef>
#include <Eigen/Core>
#include <vector>

#include "truebearing/measurement/measurement.hpp"

namespace truebearing {

/// [east, north, up] by Measurement::source; of a sensor beyond them the origin.
struct SensorSites {
  std::vector<Eigen::Vector3d> site_m{};

  /// Where a measurement was taken: as it says itself, at the height of the site where it tells none; else at the site and
  /// at rest.
  SensorState of(const Measurement& measurement) const {
    const auto source = static_cast<std::size_t>(measurement.source);
    const Eigen::Vector3d site = source < site_m.size() ? site_m[source] : Eigen::Vector3d(Eigen::Vector3d::Zero());
    SensorState sensor = measurement.sensor.value_or(SensorState{site.head<2>(), Eigen::Vector2d::Zero(), site.z()});
    if (std::isnan(sensor.up_m)) sensor.up_m = site.z();
    return sensor;
  }
};

}  // namespace truebearing
