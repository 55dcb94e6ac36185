// SPDX-License-Identifier: Apache-2.0
#include "truebearing/study/study_sites.hpp"

#include <algorithm>
#include <toml++/toml.h>

namespace truebearing {
namespace {

// East and North of a sensor in the plane, up behind them in space. The tracker has read it, and refused what is wrong.
Eigen::Vector3d site_of(const toml::table* sensor) {
  Eigen::Vector3d site_m = Eigen::Vector3d::Zero();
  const toml::array* numbers = sensor ? (*sensor)["site_m"].as_array() : nullptr;
  if (!numbers) return site_m;
  for (std::size_t i = 0; i < std::min<std::size_t>(numbers->size(), 3); ++i)
    site_m[static_cast<Eigen::Index>(i)] = (*numbers)[i].value_or(0.0);
  return site_m;
}

}  // namespace

SensorSites sensor_sites(const Study& study) {
  for (const TrackerSpec& spec : study.trackers()) {
    const toml::table* measurement = spec.configuration ? (*spec.configuration)["measurement"].as_table() : nullptr;
    if (!measurement) continue;
    SensorSites sites;
    if (const toml::table* sensors = (*measurement)["sensors"].as_table())
      for (const auto& [name, sensor] : *sensors)  // a table's keys are in order
        sites.site_m.push_back(site_of(sensor.as_table()));
    else if (measurement->contains("site_m"))
      sites.site_m.push_back(site_of(measurement));
    if (!sites.site_m.empty()) return sites;
  }
  return {};
}

}  // namespace truebearing
