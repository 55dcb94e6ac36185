// SPDX-License-Identifier: Apache-2.0
#include "truebearing/simulation/line_scenario.hpp"

#include <cmath>
#include <numeric>
#include <utility>

#include "truebearing/core/constants.hpp"

namespace truebearing {
namespace {

// Of a standard deviation.
double drawn_factor(const NoiseMixture& mixture, RandomStream& stream) {
  double left = stream.uniform();
  std::size_t component = 0;
  while (component + 1 < mixture.shares.size() && left >= mixture.shares[component])
    left -= mixture.shares[component++];
  return std::sqrt(mixture.variance_factors[component]);
}

// { shares = [...], variance_factors = [...] }
NoiseMixture read_mixture(TableReader table) {
  constexpr double kRounding = 1e-6;
  NoiseMixture mixture;
  mixture.shares = table.numbers("shares", -1, {0.0, 1.0});
  mixture.variance_factors = table.numbers("variance_factors", static_cast<int>(mixture.shares.size()), kPositive);
  if (std::abs(std::accumulate(mixture.shares.begin(), mixture.shares.end(), 0.0) - 1.0) > kRounding)
    throw table.error("shares", "do not sum to 1", "probabilities");
  table.finish();
  return mixture;
}

}  // namespace

std::optional<Measured> LineScenario::measured() const {
  return parameters_.velocity_sigma_mps ? Measured::position_velocity() : Measured::position(1);
}

Recording LineScenario::simulate(const RunKey& key) const {
  constexpr double kRounding = 1e-9;  // of a gap that is one period long
  RandomStream scenario(key, StreamId::scenario);
  RandomStream process(key, StreamId::process);
  RandomStream measurement(key, StreamId::measurement);

  Eigen::Vector2d x;
  x(0) = parameters_.position_m.draw(scenario);
  x(1) = parameters_.velocity_mps.draw(scenario);
  const double scale = parameters_.process_noise_scale.draw(scenario);
  const double noise = parameters_.noise.draw(scenario);
  const double sigma_m = parameters_.noise_is_variance ? std::sqrt(noise) : noise;
  const Eigen::Index components = parameters_.velocity_sigma_mps ? 2 : 1;
  BoundedVector its_sigma = BoundedVector::Constant(components, sigma_m);  // of a measurement
  if (parameters_.velocity_sigma_mps) its_sigma[1] = parameters_.velocity_sigma_mps->draw(scenario);

  Recording recording;
  recording.measured = measured()->components;
  recording.truth_space = &line_space();
  recording.truth.resize(1);
  double time_s = 0.0;
  const std::vector<Look> looks = parameters_.looks.draw(parameters_.period_s, parameters_.steps, key);
  recording.measurements.reserve(looks.size());
  recording.truth[0].x.reserve(looks.size());
  for (const Look& look : looks) {
    const double dt_s = look.time_s - time_s;
    time_s = look.time_s;
    const double share = std::abs(dt_s / parameters_.period_s - 1.0) < kRounding ? 1.0 : dt_s / parameters_.period_s;
    x(0) += share * parameters_.period_s * x(1);
    const Eigen::Vector2d sigma = (scale * share * parameters_.process_noise_variance).cwiseSqrt();
    for (int i = 0; i < 2; ++i) x(i) += sigma(i) * process.normal();
    Measurement taken;
    taken.time_s = time_s;
    if (parameters_.mixture) its_sigma[0] = sigma_m * drawn_factor(*parameters_.mixture, measurement);
    taken.z = x.head(components);
    for (Eigen::Index i = 0; i < components; ++i) taken.z[i] += its_sigma[i] * measurement.normal();
    if (!look.seen) taken.z.setConstant(kNaN);
    if (parameters_.reported) taken.sigma = its_sigma;
    if (!parameters_.looks.keeps(look)) continue;
    recording.counts.missing += !look.seen;
    recording.measurements.push_back(std::move(taken));
    recording.truth[0].x.emplace_back(x);
  }
  return recording;
}

std::unique_ptr<Scenario> read_line_scenario(TableReader& table) {
  LineParameters parameters;
  parameters.period_s = table.number("period_s", kPositive);
  parameters.steps = static_cast<int>(table.integer("steps", 1, 1'000'000));
  if (table.has("process_noise_variance")) {
    const std::vector<double> variance = table.numbers("process_noise_variance", 2, kNonNegative);
    parameters.process_noise_variance << variance[0], variance[1];
  }
  parameters.process_noise_scale = read_distribution_or(table, "process_noise_scale", 1.0, kNonNegative);

  TableReader target = table.table("target");
  parameters.position_m = read_distribution(target, "position_m");
  parameters.velocity_mps = read_distribution(target, "velocity_mps");
  target.finish();

  TableReader sensor = table.table("sensor");
  parameters.noise_is_variance = sensor.has("position_variance_m2");
  if (sensor.has("position_sigma_m") == parameters.noise_is_variance)
    throw sensor.error("", "needs one of two keys", "position_sigma_m or position_variance_m2");
  parameters.noise =
      read_distribution(sensor, parameters.noise_is_variance ? "position_variance_m2" : "position_sigma_m", kPositive);
  if (sensor.has("velocity_sigma_mps"))
    parameters.velocity_sigma_mps = read_distribution(sensor, "velocity_sigma_mps", kPositive);
  if (auto mixture = sensor.table_if_present("mixture")) parameters.mixture = read_mixture(std::move(*mixture));
  parameters.reported = sensor.boolean_or("reported", false);
  sensor.finish();
  parameters.looks = read_look_schedule(table);
  return std::make_unique<LineScenario>(std::move(parameters));
}

}  // namespace truebearing
