// SPDX-License-Identifier: Apache-2.0
// What a correction costs on top of the filters that it reads: the trackers of the 1-D radar family (data/studies/
// radar_1d_family.toml) on one stream of measurements. The difference of `corrected` and `ensemble` is the correction's
// own share; `bank` is the bound that stands beside it.
//     bench_correction --benchmark_repetitions=9 --benchmark_enable_random_interleaving=true
//                      --benchmark_report_aggregates_only=true
#include <benchmark/benchmark.h>

#include <array>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "kalman_bench.hpp"
#include "truebearing/correction/corrected_tracker.hpp"
#include "truebearing/filter/kalman.hpp"
#include "truebearing/filter/shared_covariance_group.hpp"
#include "truebearing/motion/constant_velocity.hpp"
#include "truebearing/tracker/filter_bank.hpp"
#include "truebearing/tracker/filter_tracker_of.hpp"
#include "truebearing/tracker/position_sensor.hpp"

namespace truebearing::bench {
namespace {

using Noise = FixedNoise<2>;
using Motion = ConstantVelocity<1, Noise>;
using Sensor = PositionSensor<1>;
using RadarTracker = FilterTrackerOf<KalmanFilter<2>, Motion, Sensor>;

Motion motion(double factor = 1.0) {
  return {Noise{factor * Eigen::Vector2d(5.0, 0.1).asDiagonal().toDenseMatrix(), kPeriod_s}};
}

Sensor sensor(double variance_m2) {
  return {Sensor::Sigma::Constant(std::sqrt(variance_m2)), 1.0};
}

std::unique_ptr<Tracker> radar_tracker(double variance_m2, const Eigen::Vector2d& P0) {
  const PriorStart prior{Eigen::Vector2d::Zero(), P0.asDiagonal().toDenseMatrix(), 0.0};
  return std::make_unique<RadarTracker>(line_space(), motion(), sensor(variance_m2), prior);
}

Ensemble ensemble() {
  Ensemble members;
  members.add("plain", radar_tracker(1e7, {999.0, 999.0}));
  members.add("wide", radar_tracker(1e7, {1e6, 53333.3}));
  members.add("tuned", radar_tracker(1.9e7, {1.3e6, 7e4}));
  return members;
}

/// A network of that many rules over the four features of the study, its terms spread over the inputs.
CorrectionModel model(int rules) {
  constexpr int kFeatures = 4;
  const auto spread = [](Eigen::Index rows, Eigen::Index cols, double size) {
    Eigen::MatrixXd values(rows, cols);
    for (Eigen::Index i = 0; i < values.size(); ++i) values(i) = size * std::sin(12.9898 * static_cast<double>(i + 1));
    return values;
  };
  CorrectionModel model;
  model.space = &line_space();
  model.design.base = "plain";
  model.design.reference = "tuned";
  model.design.covariance_of = "wide";
  model.design.features = {{FeatureKind::log_step, "", "", 0.0, 0.0, 1.0},
                           {FeatureKind::companion_difference, "position_m", "wide", 0.0, 0.0, 1000.0},
                           {FeatureKind::companion_difference, "velocity_mps", "wide", 0.0, 0.0, 100.0},
                           {FeatureKind::log_mean_nis, "", "", 0.0, 0.05, 1.0}};
  model.rules().network = FuzzyNetwork({.input_mean = Eigen::VectorXd::Zero(kFeatures),
                                        .input_scale = Eigen::VectorXd::Ones(kFeatures),
                                        .centres = spread(rules, kFeatures, 2.0),
                                        .widths = Eigen::MatrixXd::Constant(rules, kFeatures, 1.5),
                                        .consequents = spread(rules, 2, 1.0),
                                        .output_scale = Eigen::Vector2d(1000.0, 50.0)});
  model.gate = BoxGate{Eigen::VectorXd::Constant(kFeatures, -10.0), Eigen::VectorXd::Constant(kFeatures, 10.0)};
  model.rules().inflation = Eigen::VectorXd::Constant(rules, 1.2);
  model.rules().usage = Eigen::VectorXd::Constant(rules, 1.0 / rules);
  model.rules().local_mean = Eigen::MatrixXd::Zero(rules, 2);
  return model;
}

/// Steps `stepped`, a Tracker or an Ensemble, over the stream in every iteration.
template <typename Stepped>
void run(benchmark::State& state, Stepped& stepped) {
  std::vector<Measurement> stream;
  for (const double z_m : measurements(15.0))
    stream.push_back({.time_s = kPeriod_s * static_cast<double>(stream.size() + 1),
                      .z = BoundedVector::Constant(1, z_m),
                      .sigma = {},
                      .sensor = {}});
  for (auto _ : state) {
    stepped.reset();
    for (const Measurement& measurement : stream) {
      stepped.step(measurement);
      benchmark::ClobberMemory();
    }
  }
  state.counters["per_step"] = benchmark::Counter(
      static_cast<double>(kSteps), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void tracker(benchmark::State& state) {
  const auto plain = radar_tracker(1e7, {999.0, 999.0});
  run(state, *plain);
}
BENCHMARK(tracker);

void ensemble(benchmark::State& state) {
  Ensemble members = ensemble();
  run(state, members);
}
BENCHMARK(ensemble);

void corrected(benchmark::State& state) {
  CorrectedTracker tracker(ensemble(), std::make_shared<const CorrectionModel>(model(static_cast<int>(state.range()))));
  run(state, tracker);
}
BENCHMARK(corrected)->ArgName("rules")->Arg(16)->Arg(32);

void bank(benchmark::State& state) {
  const AnyMotions motions{erased(motion(0.4)), erased(motion(1.6))};
  std::vector<std::unique_ptr<AnySensor>> sensors;
  for (const double variance_factor : {0.25, 0.5, 1.0, 2.0, 4.0})
    sensors.push_back(sensor_of(sensor(1e7 * variance_factor)));
  std::vector<FilterBank::Hypothesis> hypotheses;
  std::vector<FilterGroup::Member> members;
  for (std::size_t s = 0; s < sensors.size(); ++s)
    for (std::size_t m = 0; m < motions.size(); ++m)
      for (int velocity_mps = -375; velocity_mps <= 375; velocity_mps += 50) {
        hypotheses.push_back(
            {Eigen::Vector2d(0.0, velocity_mps), Eigen::Vector2d(1e6, 484.0).asDiagonal().toDenseMatrix()});
        members.push_back({m, s});
      }
  FilterBank filters(line_space(), make_shared_covariance_group(motions, members, 1), std::move(sensors),
                     std::move(hypotheses));
  run(state, filters);
}
BENCHMARK(bank);

}  // namespace
}  // namespace truebearing::bench
