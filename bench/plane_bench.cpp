// SPDX-License-Identifier: Apache-2.0
// Nanoseconds per step of every filter in the plane, of the IMM with six modes, and of a correction with 32 rules in
// the track frame, on one stream of positions from a turning target. Filters are timed bare; trackers (`tracker_*`)
// with all that a step record takes. The difference of `tracker_corrected` and `tracker_ensemble` is the correction's
// own share.
//     bench_plane --benchmark_repetitions=9 --benchmark_enable_random_interleaving=true
//                 --benchmark_report_aggregates_only=true
#include "plane_bench.hpp"

#include <benchmark/benchmark.h>

namespace truebearing::bench {
namespace {

void count_steps(benchmark::State& state) {
  state.counters["per_step"] =
      benchmark::Counter(kSteps, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

// One filter under one motion, by positions or by range and bearing.
template <typename Filter, typename Motion, typename Model>
void filter(benchmark::State& state, const Motion& motion, const Model& model, bool by_polar) {
  std::vector<Eigen::Vector2d> z = positions();
  if (by_polar)
    for (Eigen::Vector2d& value : z) value = polar(value);
  typename Filter::State x0 = Filter::State::Zero();
  x0.template head<4>() << 5000.0, 20000.0, 0.0, 200.0;
  typename Filter::Covariance P0 = Filter::Covariance::Identity();
  P0.diagonal().template head<4>() << 1e4, 1e4, 2e4, 2e4;
  for (auto _ : state) {
    Filter run(x0, P0);
    for (const Eigen::Vector2d& value : z) {
      run.predict(motion, 1.0);
      benchmark::DoNotOptimize(run.update(on_state<Filter::kStates>(model), value));
    }
    benchmark::DoNotOptimize(run);
  }
  count_steps(state);
}

void kalman_cv(benchmark::State& s) {
  filter<KalmanFilter<4>>(s, kCv, kPosition, false);
}
void kalman_ct(benchmark::State& s) {
  filter<KalmanFilter<4>>(s, kCt, kPosition, false);
}
void kalman_ca(benchmark::State& s) {
  filter<KalmanFilter<6>>(s, kCa, kPosition, false);
}
void kalman_singer(benchmark::State& s) {
  filter<KalmanFilter<6>>(s, kSinger, kPosition, false);
}
void extended_turning(benchmark::State& s) {
  filter<KalmanFilter<5>>(s, kTurning, kPosition, false);
}
void extended_polar(benchmark::State& s) {
  filter<KalmanFilter<4>>(s, kCv, kPolar, true);
}
void unscented_turning(benchmark::State& s) {
  filter<UnscentedKalmanFilter<5>>(s, kTurning, kPosition, false);
}
void unscented_linear(benchmark::State& s) {
  filter<UnscentedKalmanFilter<4>>(s, kCv, kPosition, false);
}
void unscented_polar(benchmark::State& s) {
  filter<UnscentedKalmanFilter<4>>(s, kCv, kPolar, true);
}
BENCHMARK(kalman_cv);
BENCHMARK(kalman_ct);
BENCHMARK(kalman_ca);
BENCHMARK(kalman_singer);
BENCHMARK(extended_turning);
BENCHMARK(extended_polar);
BENCHMARK(unscented_turning);
BENCHMARK(unscented_linear);
BENCHMARK(unscented_polar);

void imm6(benchmark::State& state) {
  const std::vector<Eigen::Vector2d> z = positions();
  const std::unique_ptr<TrackedState> run = six_models();
  const Eigen::Vector4d x0(5000.0, 20000.0, 0.0, 200.0);
  const Eigen::Matrix4d P0 = Eigen::Vector4d(1e4, 1e4, 2e4, 2e4).asDiagonal();
  StateUpdate update;
  for (auto _ : state) {
    run->begin(x0.data(), P0.data());
    for (const Eigen::Vector2d& value : z) {
      run->predict(1.0);
      benchmark::DoNotOptimize(run->update(ErasedMeasurement<Position<2>>(kPosition, value, true), update));
    }
  }
  count_steps(state);
}
BENCHMARK(imm6);

template <typename Stepped>
void step_all(benchmark::State& state, Stepped& stepped) {
  const std::vector<Measurement> measurements = stream();
  for (auto _ : state) {
    stepped.reset();
    for (const Measurement& measurement : measurements) {
      stepped.step(measurement);
      benchmark::ClobberMemory();
    }
  }
  count_steps(state);
}

FilterTracker of_positions(std::unique_ptr<TrackedState> filter) {
  return {plane_space(), std::move(filter), sensor_of(PositionSensor<2>{{kSigma_m, kSigma_m}, 1.0}), TwoPointStart{}};
}

void tracker_cv(benchmark::State& state) {
  const auto tracker = cv_tracker(8.0);
  step_all(state, *tracker);
}
void tracker_imm6(benchmark::State& state) {
  FilterTracker tracker = of_positions(six_models());
  step_all(state, tracker);
}
// Eight of them in a pack (tracker_pack.hpp), each on the same stream; the time is that of one.
void step_together(benchmark::State& state, const FilterTracker& prototype) {
  const std::vector<Measurement> measurements = stream();
  const std::unique_ptr<TrackerPack> pack = prototype.pack();
  std::vector<std::unique_ptr<Tracker>> trackers;
  for (int i = 0; i < kPackLanes; ++i) trackers.push_back(prototype.fresh());
  std::vector<TrackerPack::Lane> lanes(kPackLanes);
  for (auto _ : state) {
    for (const auto& tracker : trackers) tracker->reset();
    for (const Measurement& measurement : measurements) {
      for (std::size_t i = 0; i < lanes.size(); ++i) lanes[i] = {trackers[i].get(), &measurement};
      pack->step(lanes);
      benchmark::ClobberMemory();
    }
  }
  state.counters["per_step"] = benchmark::Counter(
      kSteps * kPackLanes, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void together_cv(benchmark::State& state) {
  step_together(state, of_positions(state_of<KalmanFilter<4>>(kCv)));
}
void together_imm6(benchmark::State& state) {
  step_together(state, of_positions(six_models()));
}
void tracker_ensemble(benchmark::State& state) {
  Ensemble members = ensemble();
  step_all(state, members);
}
void tracker_corrected(benchmark::State& state) {
  CorrectedTracker tracker(ensemble(), std::make_shared<const CorrectionModel>(model(static_cast<int>(state.range()))),
                           {.referee = RefereeOptions{}});
  step_all(state, tracker);
}
BENCHMARK(tracker_cv);
BENCHMARK(tracker_imm6);
// Where the processor's registers are long enough for packs.
[[maybe_unused]] const bool has_packs = [] {
  if (!of_positions(six_models()).pack()) return false;
  benchmark::RegisterBenchmark("together_cv", together_cv);
  benchmark::RegisterBenchmark("together_imm6", together_imm6);
  return true;
}();
BENCHMARK(tracker_ensemble);
BENCHMARK(tracker_corrected)->ArgName("rules")->Arg(32)->Arg(64);

}  // namespace
}  // namespace truebearing::bench
