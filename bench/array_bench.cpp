// SPDX-License-Identifier: Apache-2.0
// Microseconds of an interval of 30 snapshots, for the trackers of a line array's targets and what they consist of:
//     past_plain            PAST alone as its paper has it, in Eigen's complex matrices: what the others are held to
//     past                  ours, alone
//     innovations           angular innovations of all targets, three ways
//     subspace              an interval of the paper: PAST, innovations, filters, records
//     joint                 an interval of the joint filter, with that many hypotheses at most
// The recording is the paper-like scenario A at 10 dB, a figure the mean over its 70 intervals after the two that begin
// the tracks; `growth` in their names: N targets that meet their neighbours, at M sensors.
//     bench_array --benchmark_repetitions=9 --benchmark_enable_random_interleaving=true
//                 --benchmark_report_aggregates_only=true
#include <benchmark/benchmark.h>

#include <Eigen/Core>
#include <string>
#include <vector>

#include "truebearing/array/angular_innovation.hpp"
#include "truebearing/array/interval.hpp"
#include "truebearing/array/projection_approximation.hpp"
#include "truebearing/array/sample_covariance.hpp"
#include "truebearing/core/angle.hpp"
#include "truebearing/simulation/line_array_scenario.hpp"
#include "truebearing/tracker/joint_angle_tracker.hpp"
#include "truebearing/tracker/subspace_angle_tracker.hpp"

namespace truebearing::bench {
namespace {

constexpr int kStarting = 2;  // intervals that begin the tracks
constexpr int kIntervals = 70;
constexpr double kBeta = 0.95;
constexpr double kSquareDegree = radians(1.0) * radians(1.0);

enum class Motion { still, moving };  // of the targets inside an interval

Recording paper_like(Motion motion) {
  const std::string scenarios = TRUEBEARING_SOURCE_DIR "/data/scenarios/";
  return load_scenario(scenarios + (motion == Motion::moving ? "array_a_moving_10db.toml" : "array_a_10db.toml"))
      ->simulate({});
}

// N targets evenly between -50 and 50 degrees, each on its way to a neighbour and beyond.
Recording growing(int N, int M) {
  LineArrayParameters parameters;
  parameters.intervals = kStarting + kIntervals;
  parameters.sensors = M;
  parameters.snr_db = 10.0;
  const double apart_deg = 100.0 / (N - 1);
  for (int n = 0; n < N; ++n) {
    AnglePath path;
    path.start_rad = radians(-50.0 + n * apart_deg);
    path.rate_radps = radians((n % 2 == 0 ? 0.75 : -0.75) * apart_deg / kIntervals);
    parameters.targets.push_back({path, -1e9, 1e9});
  }
  return LineArrayScenario(parameters).simulate({});
}

void count_intervals(benchmark::State& state) {
  state.counters["per_interval"] =
      benchmark::Counter(kIntervals, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

// The basis that the tracks' first two intervals end with.
Eigen::MatrixXcd first_basis(const Recording& recording, int N) {
  Interval interval;
  interval.take(*recording.measurements[kStarting - 1].snapshots);
  Eigen::MatrixXcd R;
  sample_covariance(interval, R);
  return signal_subspace(R, N).basis;
}

/// Yang 1995, table I. g^H is kept as a row: its conjugation inside the outer products costs as much as all the rest.
class PlainPast {
 public:
  void begin(const Eigen::MatrixXcd& basis) {
    const Eigen::Index M = basis.rows(), N = basis.cols();
    W_ = basis;
    P_.setIdentity(N, N);
    y_.resize(N);
    h_.resize(N);
    g_H_.resize(N);
    e_.resize(M);
  }
  void update(const Eigen::MatrixXcd& snapshots) {
    for (Eigen::Index t = 0; t < snapshots.cols(); ++t) {
      const auto x = snapshots.col(t);
      y_.noalias() = W_.adjoint() * x;
      h_.noalias() = P_ * y_;
      g_H_ = h_.adjoint() / (kBeta + y_.dot(h_).real());
      P_.noalias() -= h_ * g_H_;
      P_ /= kBeta;
      P_.triangularView<Eigen::StrictlyUpper>() = P_.adjoint();
      e_ = x;
      e_.noalias() -= W_ * y_;
      W_.noalias() += e_ * g_H_;
    }
  }
  const Eigen::MatrixXcd& basis() const { return W_; }

 private:
  Eigen::MatrixXcd W_, P_;
  Eigen::VectorXcd y_, h_, e_;
  Eigen::RowVectorXcd g_H_;
};

void past_plain(benchmark::State& state) {
  const Recording recording = paper_like(Motion::still);
  const Eigen::MatrixXcd basis = first_basis(recording, 5);
  std::vector<Eigen::MatrixXcd> intervals;
  for (int k = kStarting; k < kStarting + kIntervals; ++k) {
    const SnapshotBlock& block = *recording.measurements[static_cast<std::size_t>(k)].snapshots;
    intervals.push_back(Eigen::Map<const Eigen::MatrixXcd>(block.values.data(), block.sensors, block.snapshots()));
  }
  PlainPast past;
  for (auto _ : state) {
    past.begin(basis);
    for (const Eigen::MatrixXcd& snapshots : intervals) {
      past.update(snapshots);
      benchmark::ClobberMemory();
    }
    benchmark::DoNotOptimize(past.basis().data());
  }
  count_intervals(state);
}
BENCHMARK(past_plain)->Unit(benchmark::kMicrosecond);

void past(benchmark::State& state) {
  const Recording recording = paper_like(Motion::still);
  const Eigen::MatrixXcd basis = first_basis(recording, 5);
  std::vector<Interval> intervals(kIntervals);
  for (int k = 0; k < kIntervals; ++k)
    intervals[static_cast<std::size_t>(k)].take(
        *recording.measurements[static_cast<std::size_t>(k + kStarting)].snapshots);
  ProjectionApproximation past(kBeta);
  for (auto _ : state) {
    past.begin(basis);
    for (const Interval& interval : intervals) {
      past.update(interval);
      benchmark::ClobberMemory();
    }
    benchmark::DoNotOptimize(past.basis().re.data());
  }
  count_intervals(state);
}
BENCHMARK(past)->Unit(benchmark::kMicrosecond);

// Innovations of all targets at the true angles, from the subspace of every interval.
template <typename Innovation>
void innovations(benchmark::State& state) {
  const Recording recording = paper_like(Motion::still);
  const auto N = static_cast<Eigen::Index>(recording.truth.size());
  ProjectionApproximation past(kBeta);
  past.begin(first_basis(recording, static_cast<int>(N)));
  struct Told {
    SplitMatrix<double> W, a, b;
  };
  std::vector<Told> intervals;
  for (std::size_t k = kStarting; k < kStarting + kIntervals; ++k) {
    Interval interval;
    interval.take(*recording.measurements[k].snapshots);
    past.update(interval);
    Told told{past.basis(), {}, {}};
    told.a.setZero(told.W.rows(), N);
    told.b.setZero(told.W.rows(), N);
    const LineArray array{interval.sensors(), interval.spacing_wavelengths()};
    for (Eigen::Index n = 0; n < N; ++n)
      array.steer(recording.truth[static_cast<std::size_t>(n)].x[k][0], n, told.a, told.b);
    intervals.push_back(told);
  }
  Innovation innovation;
  for (auto _ : state)
    for (const Told& told : intervals) {
      innovation.prepare(told.W);
      for (Eigen::Index n = 0; n < N; ++n) benchmark::DoNotOptimize(innovation(told.a, told.b, n));
    }
  count_intervals(state);
}
BENCHMARK(innovations<ImplicitInnovation<double>>)->Name("innovations/implicit")->Unit(benchmark::kMicrosecond);
BENCHMARK(innovations<ProjectionInnovation<double>>)->Name("innovations/projection")->Unit(benchmark::kMicrosecond);
BENCHMARK(innovations<RyuInnovation<double>>)->Name("innovations/ryu")->Unit(benchmark::kMicrosecond);

// A run per iteration; what begins the tracks is left out.
void track(benchmark::State& state, Tracker& tracker, const Recording& recording) {
  const auto first = recording.measurements.begin() + kStarting;
  for (auto _ : state) {
    state.PauseTiming();
    tracker.reset();
    for (auto starting = recording.measurements.begin(); starting != first; ++starting) tracker.step(*starting);
    state.ResumeTiming();
    for (auto measurement = first; measurement != first + kIntervals; ++measurement) {
      benchmark::DoNotOptimize(tracker.step(*measurement).data());
      benchmark::ClobberMemory();
    }
  }
  if (tracker.counts().failed > 0) state.SkipWithError("the tracker failed");
  count_intervals(state);
}

SubspaceAngleOptions subspace_options(int N, SubspaceAngleOptions::Innovation innovation) {
  SubspaceAngleOptions options;
  options.targets = N;
  options.innovation = innovation;
  options.beta = kBeta;
  options.q_rad2ps3 = kSquareDegree;
  options.sigma_rad = radians(2.0);
  return options;
}

void subspace(benchmark::State& state, SubspaceAngleOptions::Innovation innovation) {
  SubspaceAngleTracker tracker(subspace_options(5, innovation));
  track(state, tracker, paper_like(Motion::still));
}
BENCHMARK_CAPTURE(subspace, implicit, SubspaceAngleOptions::Innovation::implicit)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(subspace, projection, SubspaceAngleOptions::Innovation::projection)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(subspace, ryu, SubspaceAngleOptions::Innovation::ryu)->Unit(benchmark::kMicrosecond);

// Of data/studies/array_random_10db.toml.
JointAngleOptions joint_options(int N, int beam, int moving_blocks) {
  JointAngleOptions options;
  options.targets = N;
  options.hypotheses.beam = beam;
  options.hypotheses.motion.q0 = options.hypotheses.motion.q_low = 0.001 * kSquareDegree;
  options.hypotheses.motion.q_high = kSquareDegree;
  options.hypotheses.motion.log_power_variance_per_s = 0.001;
  options.rate_sigma_radps = radians(2.0);
  options.moving_blocks = moving_blocks;
  options.noise_power = 1.0;
  return options;
}

void joint(benchmark::State& state) {
  const int blocks = static_cast<int>(state.range(1));
  JointAngleTracker tracker(joint_options(5, static_cast<int>(state.range(0)), blocks));
  track(state, tracker, paper_like(blocks > 0 ? Motion::moving : Motion::still));
}
BENCHMARK(joint)
    ->ArgNames({"beam", "moving_blocks"})
    ->Args({8, 0})
    ->Args({1, 0})
    ->Args({8, 3})
    ->Args({1, 3})
    ->Unit(benchmark::kMicrosecond);

void subspace_growth(benchmark::State& state) {
  const int N = static_cast<int>(state.range(0)), M = static_cast<int>(state.range(1));
  SubspaceAngleTracker tracker(subspace_options(N, SubspaceAngleOptions::Innovation::implicit));
  track(state, tracker, growing(N, M));
}
void joint_growth(benchmark::State& state) {
  const int N = static_cast<int>(state.range(0)), M = static_cast<int>(state.range(1));
  JointAngleTracker tracker(joint_options(N, 8, 0));
  track(state, tracker, growing(N, M));
}
BENCHMARK(subspace_growth)->ArgNames({"N", "M"})->ArgsProduct({{2, 5, 8}, {15, 30, 60}})->Unit(benchmark::kMicrosecond);
BENCHMARK(joint_growth)->ArgNames({"N", "M"})->ArgsProduct({{2, 5, 8}, {15, 30, 60}})->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace truebearing::bench
