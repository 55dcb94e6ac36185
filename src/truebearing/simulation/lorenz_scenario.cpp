// SPDX-License-Identifier: Apache-2.0
#include "truebearing/simulation/lorenz_scenario.hpp"

#include <cmath>
#include <Eigen/Geometry>
#include <algorithm>
#include <vector>

#include "truebearing/core/angle.hpp"
#include "truebearing/core/constants.hpp"

namespace truebearing {
namespace {

constexpr Range kAngle_deg{-360.0, 360.0};

Eigen::Vector3d crossed(const AnyLorenzMotion& motion, Eigen::Vector3d x, double dt_s) {
  // In parts, for a motion crosses no more than so many of its pieces at once; a part is no less than a piece.
  const double part_s = std::max(0.02, std::visit([](const auto& model) { return model.step_s; }, motion));
  for (double left_s = dt_s; left_s > 0.0; left_s -= part_s)
    x = std::visit([&](const auto& model) { return model.f(x, std::min(left_s, part_s)); }, motion);
  return x;
}

}  // namespace

Recording LorenzScenario::simulate(const RunKey& key) const {
  RandomStream scenario(key, StreamId::scenario);
  RandomStream process(key, StreamId::process);
  RandomStream measurement(key, StreamId::measurement);

  Eigen::Vector3d x;
  for (int i = 0; i < 3; ++i) x(i) = parameters_.start[static_cast<std::size_t>(i)].draw(scenario);
  const double sigma = parameters_.sigma.draw(scenario);
  x = crossed(parameters_.truth, x, parameters_.burn_in_s);

  const int lead = parameters_.lead_steps;
  const std::vector<Look> looks = parameters_.looks.draw(parameters_.period_s, parameters_.steps + lead, key);
  std::vector<BoundedVector> states;
  double time_s = 0.0;
  for (const Look& look : looks) {
    const double dt_s = look.time_s - time_s;
    time_s = look.time_s;
    x = crossed(parameters_.truth, x, dt_s);
    const double spread = parameters_.process_sigma * std::sqrt(dt_s / parameters_.period_s);
    for (int i = 0; i < 3; ++i) x(i) += spread * process.normal();
    states.emplace_back(x);
  }

  Recording recording;
  recording.measured = measured()->components;
  recording.truth_space = &lorenz_space();
  recording.truth.resize(1);
  for (std::size_t k = 0; k + static_cast<std::size_t>(lead) < looks.size(); ++k) {
    Measurement taken;
    taken.time_s = looks[k].time_s;
    taken.z = parameters_.rotation * Eigen::Vector3d(states[k]);
    for (int i = 0; i < 3; ++i) taken.z[i] += sigma * measurement.normal();
    if (!looks[k].seen) taken.z.setConstant(kNaN);
    if (parameters_.reported) taken.sigma = BoundedVector::Constant(3, sigma);
    if (!parameters_.looks.keeps(looks[k])) continue;
    recording.counts.missing += !looks[k].seen;
    recording.measurements.push_back(std::move(taken));
    recording.truth[0].x.push_back(states[k + static_cast<std::size_t>(lead)]);
  }
  return recording;
}

Eigen::Matrix3d rotation_of(const std::vector<double>& roll_pitch_yaw_deg) {
  const auto turn = [&](std::size_t angle, const Eigen::Vector3d& axis) {
    return Eigen::AngleAxisd(radians(roll_pitch_yaw_deg[angle]), axis).toRotationMatrix();
  };
  return turn(2, Eigen::Vector3d::UnitZ()) * turn(1, Eigen::Vector3d::UnitY()) * turn(0, Eigen::Vector3d::UnitX());
}

AnyLorenzMotion read_lorenz_motion(TableReader& table, double sigma) {
  constexpr Range kStep_s{1e-5, 1.0};
  if (table.choice("model", {"lorenz_taylor", "lorenz_rk4"}) == "lorenz_rk4")
    return LorenzMotion<LorenzRungeKutta>{{}, table.number("step_s", kStep_s), sigma};
  const int terms = static_cast<int>(table.integer("terms", 1, 20));
  return LorenzMotion<LorenzTaylor>{{terms}, table.number("step_s", kStep_s), sigma};
}

std::unique_ptr<Scenario> read_lorenz_scenario(TableReader& table) {
  LorenzParameters parameters;
  parameters.period_s = table.number("period_s", kPositive);
  parameters.steps = static_cast<int>(table.integer("steps", 1, 1'000'000));
  parameters.process_sigma = table.number_or("process_sigma", 0.0, kNonNegative);
  parameters.lead_steps = static_cast<int>(table.integer_or("lead_steps", 0, 0, 1000));

  TableReader truth = table.table("truth");
  parameters.truth = read_lorenz_motion(truth, 0.0);
  truth.finish();

  TableReader start = table.table("start");
  constexpr std::array kNames{"x", "y", "z"};
  for (std::size_t i = 0; i < kNames.size(); ++i) parameters.start[i] = read_distribution(start, kNames[i]);
  parameters.burn_in_s = start.number_or("burn_in_s", 0.0, {0.0, 1000.0});
  start.finish();

  TableReader sensor = table.table("sensor");
  parameters.sigma = read_distribution(sensor, "sigma", kPositive);
  if (sensor.has("rotation_deg")) parameters.rotation = rotation_of(sensor.numbers("rotation_deg", 3, kAngle_deg));
  parameters.reported = sensor.boolean_or("reported", false);
  sensor.finish();
  parameters.looks = read_look_schedule(table);
  return std::make_unique<LorenzScenario>(std::move(parameters));
}

}  // namespace truebearing
