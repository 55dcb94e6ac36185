// SPDX-License-Identifier: Apache-2.0
// Milliseconds for a bearings-only solution: by least squares from 225 starts, k <= 10 iterations each, and in modified
// polar coordinates from three starts and from one.
//     bench_tma --benchmark_repetitions=9 --benchmark_enable_random_interleaving=true
//               --benchmark_report_aggregates_only=true
#include "tma_bench.hpp"

#include <benchmark/benchmark.h>

#include <stdexcept>

#include "truebearing/simulation/bearings_only_scenario.hpp"
#include "truebearing/tma/target_motion_batch.hpp"
#include "truebearing/tma/cho_2015.hpp"

namespace truebearing::bench {
namespace {

constexpr const char* kScenario = TRUEBEARING_SOURCE_DIR "/data/scenarios/cho_s1.toml";

// The scenario with as short a period as it takes to have so many bearings.
Recording recording_of(int bearings) {
  const std::unique_ptr<Scenario> scenario = load_scenario(kScenario);
  BearingsOnlyParameters parameters = dynamic_cast<const BearingsOnlyScenario&>(*scenario).parameters();
  for (const double period_s : {4.0, 3.0, 2.0, 1.0}) {
    parameters.period_s = period_s;
    Recording recording = BearingsOnlyScenario(parameters).simulate({});
    if (static_cast<int>(recording.measurements.size()) - recording.counts.missing >= bearings) return recording;
  }
  throw std::invalid_argument("the scenario is too short for so many bearings");
}

BearingWindow window_of(const BearingsProblem& problem) {
  BearingWindow window;
  for (const BearingsProblem::Bearing& bearing : problem.bearings)
    window.add(bearing.time_s, bearing.bearing_rad, problem.sigma_rad, bearing.own_ship_m);
  return window;
}

void cho(benchmark::State& state, ChoOptions::Method method) {
  const BearingWindow window = window_of(bearings_problem(static_cast<int>(state.range(0))));
  BatchEstimate estimate;
  for (auto _ : state) benchmark::DoNotOptimize(estimate = solve_cho(window, {.method = method}));
  state.counters["least_cost"] = estimate.cost;
}

void modified_polar(benchmark::State& state, TargetMotionBatchOptions options) {
  const BearingWindow window = window_of(bearings_problem(static_cast<int>(state.range(0))));
  TargetMotionBatch batch(std::move(options));
  BatchEstimate estimate;
  for (auto _ : state) benchmark::DoNotOptimize(estimate = batch.solve(window));
  state.counters["least_cost"] = estimate.cost;
}

void sizes(benchmark::internal::Benchmark* timed) {
  for (const int bearings : kProblemSizes) timed->Arg(bearings);
  timed->Unit(benchmark::kMillisecond);
}

BENCHMARK_CAPTURE(cho, levenberg_marquardt_225, ChoOptions::Method::levenberg_marquardt)->Apply(sizes);
BENCHMARK_CAPTURE(cho, gauss_newton_225, ChoOptions::Method::gauss_newton)->Apply(sizes);
BENCHMARK_CAPTURE(modified_polar, three_starts, TargetMotionBatchOptions{})->Apply(sizes);
BENCHMARK_CAPTURE(modified_polar, one_start, TargetMotionBatchOptions{.start_ranges_m = {6000.0}})->Apply(sizes);

}  // namespace

BearingsProblem bearings_problem(int bearings) {
  BearingsProblem problem;
  double begin_s = 0.0;
  for (const Measurement& measurement : recording_of(bearings).measurements) {
    if (measurement.is_missing()) continue;
    if (static_cast<int>(problem.bearings.size()) == bearings) break;
    problem.sigma_rad = measurement.sigma[0];
    if (problem.bearings.empty()) begin_s = measurement.time_s;
    problem.bearings.push_back({measurement.time_s - begin_s, measurement.sensor->position_m, measurement.z[0]});
  }
  const BearingWindow window = window_of(problem);
  for (int i = 0; i < kChoStarts; ++i) problem.starts.push_back(cho_start(window, i));
  return problem;
}

}  // namespace truebearing::bench
