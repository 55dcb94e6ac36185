// SPDX-License-Identifier: Apache-2.0
#include "truebearing/simulation/planar_legs_scenario.hpp"

#include <algorithm>
#include <cmath>

#include "truebearing/core/angle.hpp"

namespace truebearing {
namespace {

// The state after t seconds of a leg, exactly.
Eigen::Vector4d flown(const PlanarLeg& leg, const Eigen::Vector4d& start, double t) {
  const Eigen::Vector2d v = start.tail<2>();
  Eigen::Vector4d end;
  if (leg.turn_rate_radps == 0.0) {
    end << start.head<2>() + t * v + 0.5 * t * t * leg.acceleration_mps2, v + t * leg.acceleration_mps2;
    return end;
  }
  const double w = leg.turn_rate_radps, c = std::cos(w * t), s = std::sin(w * t);
  const Eigen::Vector2d right(v.y(), -v.x());  // v turned by 90 degrees to starboard
  end << start.head<2>() + s / w * v + (1.0 - c) / w * right, c * v + s * right;
  return end;
}

}  // namespace

Recording PlanarLegsScenario::simulate(const RunKey& key) const {
  // A sample that rounding puts beyond the end of a leg by this much still belongs to it.
  constexpr double kRounding_s = 1e-9;
  RandomStream scenario(key, StreamId::scenario);
  RandomStream measurement(key, StreamId::measurement);
  const double sigma_m = parameters_.sensor.sigma_m.draw(scenario);

  Recording recording;
  recording.measured = parameters_.sensor.measured().components;
  recording.truth_space = &plane_space();
  recording.truth.resize(1);
  recording.phases = parameters_.phases;
  Eigen::Vector4d x = parameters_.start;
  double begin_s = 0.0;
  int k = 0;
  for (const PlanarLeg& leg : parameters_.legs) {
    const double end_s = begin_s + leg.duration_s;
    for (; k * parameters_.period_s <= end_s + kRounding_s; ++k) {
      const double time_s = k * parameters_.period_s;
      const Eigen::Vector4d state = flown(leg, x, std::max(time_s - begin_s, 0.0));
      recording.measurements.push_back(parameters_.sensor.measure(time_s, state, sigma_m, measurement));
      recording.truth[0].x.emplace_back(state);
      if (!parameters_.phases.empty()) recording.truth[0].phase.push_back(leg.phase);
    }
    x = flown(leg, x, leg.duration_s);
    begin_s = end_s;
  }
  return recording;
}

std::unique_ptr<Scenario> read_planar_legs_scenario(TableReader& table) {
  PlanarLegsParameters parameters;
  std::vector<std::string> outputs = planar_outputs();
  outputs.erase(std::remove(outputs.begin(), outputs.end(), "range"), outputs.end());  // the truth is in the plane
  const std::string output = table.choice_or("output", outputs, "plane");
  parameters.period_s = table.number("period_s", {0.0, 3600.0, true});
  TableReader target = table.table("target");
  const std::vector<double> position_m = target.numbers("position_m", 2);
  const std::vector<double> velocity_mps = target.numbers("velocity_mps", 2);
  target.finish();
  parameters.start << position_m[0], position_m[1], velocity_mps[0], velocity_mps[1];
  for (TableReader& leg : table.tables("legs")) {
    PlanarLeg read;
    read.duration_s = leg.number("duration_s", {0.0, 1e6, true});
    if (leg.has("turn_rate_degps")) read.turn_rate_radps = radians(leg.number("turn_rate_degps"));
    if (leg.has("acceleration_mps2")) {
      const std::vector<double> a = leg.numbers("acceleration_mps2", 2);
      read.acceleration_mps2 << a[0], a[1];
      if (read.turn_rate_radps != 0.0) throw leg.error("acceleration_mps2", "stands beside a turn rate", "one of them");
    }
    const std::string phase = leg.text_or("phase", "");
    if (!phase.empty()) {
      auto& names = parameters.phases;
      if (std::find(names.begin(), names.end(), phase) == names.end()) names.push_back(phase);
      read.phase = static_cast<int>(std::find(names.begin(), names.end(), phase) - names.begin());
    } else if (!parameters.phases.empty()) {
      throw leg.error("phase", "is missing", "a name for every leg, or for none");
    }
    parameters.legs.push_back(read);
    leg.finish();
  }
  if (parameters.legs.empty()) throw table.error("legs", "is missing or empty", "an array of tables, [[legs]]");
  parameters.sensor = read_planar_sensor(table.table("sensor"), output);
  return std::make_unique<PlanarLegsScenario>(std::move(parameters));
}

}  // namespace truebearing
