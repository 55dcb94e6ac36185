// SPDX-License-Identifier: Apache-2.0
// Nanoseconds per step of every filter in the plane, of the IMM with six modes, and of a correction with 32 rules in
// the track frame, on one stream of positions from a turning target. Filters are timed bare; trackers (`tracker_*`)
// with all that a step record takes. The difference of `tracker_corrected` and `tracker_ensemble` is the correction's
// own share.
//     bench_plane --benchmark_repetitions=9 --benchmark_enable_random_interleaving=true
//                 --benchmark_report_aggregates_only=true
#include <benchmark/benchmark.h>

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "truebearing/core/random.hpp"
#include "truebearing/correction/corrected_tracker.hpp"
#include "truebearing/filter/interacting_multiple_model.hpp"
#include "truebearing/filter/kalman.hpp"
#include "truebearing/filter/unscented.hpp"
#include "truebearing/measurement/longer_state.hpp"
#include "truebearing/measurement/position.hpp"
#include "truebearing/measurement/range_bearing.hpp"
#include "truebearing/motion/constant_acceleration.hpp"
#include "truebearing/motion/constant_velocity.hpp"
#include "truebearing/motion/coordinated_turn.hpp"
#include "truebearing/motion/singer.hpp"
#include "truebearing/motion/turning_target.hpp"
#include "truebearing/tracker/filter_tracker_of.hpp"
#include "truebearing/tracker/position_sensor.hpp"

namespace truebearing::bench {
namespace {

constexpr int kSteps = 1000;
constexpr double kSigma_m = 100.0;

std::vector<Eigen::Vector2d> positions() {
  std::vector<Eigen::Vector2d> z;
  RandomStream random({}, StreamId::test);
  Eigen::Vector2d position(5000.0, 20000.0);
  for (int k = 0; k < kSteps; ++k) {
    const double course = 0.7 * std::sin(0.01 * k);
    position += 200.0 * Eigen::Vector2d(std::sin(course), std::cos(course));
    z.push_back(position + kSigma_m * Eigen::Vector2d(random.normal(), random.normal()));
  }
  return z;
}

void count_steps(benchmark::State& state) {
  state.counters["per_step"] =
      benchmark::Counter(kSteps, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

Eigen::Vector2d polar(const Eigen::Vector2d& position) {
  return {position.norm(), std::atan2(position.x(), position.y())};
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

using Cv = ConstantVelocity<2, DiscreteWhiteNoise>;
using Ct = CoordinatedTurn<DiscreteWhiteNoise>;
const Position<2> kPosition{{kSigma_m, kSigma_m}};
const RangeBearing<> kPolar{{0.0, 0.0}, 50.0, 0.005};
const Cv kCv{{8.0}};
const Ct kCt{{2.0}, 0.03};
const ConstantAcceleration<2> kCa{{4.0}};
const Singer<2> kSinger{10.0, 20.0};
const TurningTarget<DiscreteWhiteNoise> kTurning{{2.0}, 0.01};

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
BENCHMARK(unscented_polar);

std::unique_ptr<TrackedState> six_models() {
  InteractingMultipleModel::Modes modes;
  modes.push_back(state_of<KalmanFilter<4>>(Cv{{0.55}}));
  for (const double rate_degps : {-5.0, -2.0, 2.0, 5.0})
    modes.push_back(state_of<KalmanFilter<4>>(Ct{{2.1}, rate_degps * 0.0174533}));
  modes.push_back(state_of<KalmanFilter<4>>(Cv{{22.5}}));
  return std::make_unique<InteractingMultipleModel>(std::move(modes), star_chain(6, 0.037, 0.084, 0.7, 1.0));
}

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

using CvTracker = FilterTrackerOf<KalmanFilter<4>, Cv, PositionSensor<2>>;

std::unique_ptr<Tracker> cv_tracker(double sigma_a) {
  return std::make_unique<CvTracker>(plane_space(), Cv{{sigma_a}}, PositionSensor<2>{{kSigma_m, kSigma_m}, 1.0},
                                     TwoPointStart{});
}

Ensemble ensemble() {
  Ensemble members;
  members.add("plain", cv_tracker(8.0));
  members.add("tuned", cv_tracker(20.0));
  return members;
}

// The features of data/studies/manoeuvre_2d.toml, with a network of its size.
CorrectionModel model(int rules) {
  CorrectionModel model;
  model.space = &plane_space();
  model.design.base = model.design.covariance_of = "plain";
  model.design.reference = "tuned";
  model.design.covariance_moments = true;
  model.design.frame = Frame::track;
  for (const double alpha : {0.0, 0.5, 0.2, 0.08})
    for (const char* component : {"along_m", "cross_m"})
      model.design.features.push_back({.kind = alpha > 0.0 ? FeatureKind::innovation_average : FeatureKind::innovation,
                                       .component = component,
                                       .companion = {},
                                       .alpha = alpha});
  const auto d = static_cast<Eigen::Index>(model.design.features.size());
  const auto spread = [](Eigen::Index rows, Eigen::Index cols, double size) {
    Eigen::MatrixXd values(rows, cols);
    for (Eigen::Index i = 0; i < values.size(); ++i) values(i) = size * std::sin(12.9898 * static_cast<double>(i + 1));
    return values;
  };
  model.rules().network = FuzzyNetwork({.input_mean = Eigen::VectorXd::Zero(d),
                                        .input_scale = Eigen::VectorXd::Ones(d),
                                        .centres = spread(rules, d, 2.0),
                                        .widths = Eigen::MatrixXd::Constant(rules, d, 1.5),
                                        .consequents = spread(rules, 4, 1.0),
                                        .output_scale = Eigen::Vector4d(80.0, 80.0, 40.0, 40.0)});
  model.gate = BoxGate{Eigen::VectorXd::Constant(d, -20.0), Eigen::VectorXd::Constant(d, 20.0)};
  model.rules().moments = Eigen::MatrixXd::Zero(rules, 16);
  for (Eigen::Index j = 0; j < rules; ++j)
    model.rules().moments.row(j) = Eigen::Matrix4d::Identity().reshaped().transpose();
  model.rules().usage = Eigen::VectorXd::Constant(rules, 1.0 / rules);
  model.rules().local_mean = Eigen::MatrixXd::Zero(rules, 4);
  return model;
}

template <typename Stepped>
void step_all(benchmark::State& state, Stepped& stepped) {
  std::vector<Measurement> stream;
  for (const Eigen::Vector2d& z : positions()) {
    Measurement measurement;
    measurement.time_s = static_cast<double>(stream.size() + 1);
    measurement.z = z;
    stream.push_back(measurement);
  }
  for (auto _ : state) {
    stepped.reset();
    for (const Measurement& measurement : stream) {
      stepped.step(measurement);
      benchmark::ClobberMemory();
    }
  }
  count_steps(state);
}

void tracker_cv(benchmark::State& state) {
  const auto tracker = cv_tracker(8.0);
  step_all(state, *tracker);
}
void tracker_imm6(benchmark::State& state) {
  FilterTracker tracker(plane_space(), six_models(), sensor_of(PositionSensor<2>{{kSigma_m, kSigma_m}, 1.0}),
                        TwoPointStart{});
  step_all(state, tracker);
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
BENCHMARK(tracker_ensemble);
BENCHMARK(tracker_corrected)->ArgName("rules")->Arg(32)->Arg(64);

}  // namespace
}  // namespace truebearing::bench
