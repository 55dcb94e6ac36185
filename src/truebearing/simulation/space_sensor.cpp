// SPDX-License-Identifier: Apache-2.0
#include "truebearing/simulation/space_sensor.hpp"

#include <cmath>
#include <stdexcept>

#include "truebearing/core/angle.hpp"
#include "truebearing/measurement/bearing_elevation.hpp"
#include "truebearing/measurement/range_bearing_elevation_rate.hpp"

namespace truebearing {
namespace {

using SpaceState = SpaceOutput::State;

const std::vector<SpaceOutput>& space_table() {
  static const std::vector<SpaceOutput> the_table{
      {"space",
       Measured::position(3),
       [](const SpaceState& state) -> BoundedVector { return state.head<3>(); },
       {"position_sigma_m"}},
      {"range_bearing_elevation",
       RangeBearingElevation<>::measured(),
       [](const SpaceState& state) -> BoundedVector {
         const SightInSpace<double> sight(state.head<3>());
         return Eigen::Vector3d(sight.range_m, sight.bearing_rad, sight.elevation_rad);
       },
       {"range_sigma_m", "bearing_sigma_deg", "elevation_sigma_deg"},
       1},
      {"range_bearing_elevation_rate",
       RangeBearingElevationRate<>::measured(),
       [](const SpaceState& state) -> BoundedVector {
         const SightInSpace<double> sight(state.head<3>());
         return Eigen::Vector4d(sight.range_m, sight.bearing_rad, sight.elevation_rad,
                                sight.range_rate(state.tail<3>()));
       },
       {"range_sigma_m", "bearing_sigma_deg", "elevation_sigma_deg", "range_rate_sigma_mps"},
       1,
       true},
      {"bearing_elevation",
       BearingElevation<>::measured(),
       [](const SpaceState& state) -> BoundedVector {
         const SightInSpace<double> sight(state.head<3>());
         return Eigen::Vector2d(sight.bearing_rad, sight.elevation_rad);
       },
       {"bearing_sigma_deg", "elevation_sigma_deg"},
       0},
  };
  return the_table;
}

}  // namespace

const SpaceOutput& space_output(const std::string& name) {
  for (const SpaceOutput& output : space_table())
    if (output.name == name) return output;
  throw std::out_of_range("no output of a sensor in space: " + name);
}

std::vector<std::string> space_outputs() {
  std::vector<std::string> names;
  for (const SpaceOutput& output : space_table()) names.push_back(output.name);
  return names;
}

Measurement SpaceSensor::measure(double time_s, const SpaceState& state, RandomStream& stream) const {
  Measurement taken;
  taken.time_s = time_s;
  taken.z = output->h(state);
  BoundedVector noise(taken.z.size());
  for (double& value : noise) value = stream.normal();
  const Eigen::Index last = noise.size() - 1;
  if (output->has_range_rate) {
    const double rho = range_rate_correlation;
    noise[last] = rho * noise[0] + std::sqrt(1.0 - rho * rho) * noise[last];
  }
  taken.z += noise.cwiseProduct(sigma);
  if (output->bearing >= 0) taken.z[output->bearing] = wrap_pi(taken.z[output->bearing]);
  if (reported) taken.sigma = sigma;
  return taken;
}

SpaceSensor read_space_sensor(TableReader table, const std::string& output) {
  constexpr double kNearlyOne = 0.999;
  SpaceSensor sensor;
  sensor.output = &space_output(output);
  sensor.sigma.resize(static_cast<Eigen::Index>(sensor.output->measured.components.size()));
  for (std::size_t i = 0; i < sensor.output->sigma_keys.size(); ++i) {
    const std::string& key = sensor.output->sigma_keys[i];
    const double sigma =
        key.ends_with("_deg") ? radians(table.number(key, {0.0, 90.0, true})) : table.number(key, kPositive);
    sensor.sigma.tail(sensor.sigma.size() - static_cast<Eigen::Index>(i)).setConstant(sigma);
  }
  if (sensor.output->has_range_rate)
    sensor.range_rate_correlation = table.number_or("range_rate_correlation", 0.0, {-kNearlyOne, kNearlyOne});
  sensor.reported = table.boolean_or("reported", false);
  table.finish();
  return sensor;
}

}  // namespace truebearing
