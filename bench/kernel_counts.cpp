// SPDX-License-Identifier: Apache-2.0
// The library's kernels, each run once under valgrind's callgrind, which counts instructions between the beginning and the end
// of truebearing_counted() alone (kernel_counts.py). Prints the compiler, then per kernel its name and its steps.
//     kernel_counts --compiler    the compiler alone
#include <cstdio>
#include <cstring>
#include <functional>
#include <memory>
#include <vector>

#include "plane_bench.hpp"
#include "recurrent_bench.hpp"
#include "truebearing/core/angle.hpp"
#include "truebearing/simulation/planar_flight_scenario.hpp"
#include "truebearing/simulation/scenario.hpp"
#include "truebearing/tma/cho_2015.hpp"
#include "truebearing/tma/target_motion_batch.hpp"
#include "truebearing/tracker/joint_angle_tracker.hpp"
#include "truebearing/tracker/particle_cloud.hpp"
#include "truebearing/tracker/subspace_angle_tracker.hpp"

extern "C" [[gnu::noinline]] void truebearing_counted(const std::function<void()>& run) {
  run();
  asm volatile("" : : : "memory");  // not the last call, which would be a jump out of it
}

namespace truebearing::bench {
namespace {

template <typename Value>
void keep(const Value& value) {
  asm volatile("" : : "m"(value) : "memory");
}

// Once before it is counted: code is chosen, and memory is there.
void count(const char* name, int steps, const std::function<void()>& run) {
  run();
  truebearing_counted(run);
  std::printf("%s %d\n", name, steps);
}

template <typename Filter, typename Motion, typename Model>
void filter(const char* name, const Motion& motion, const Model& model) {
  using Measured = Eigen::Matrix<double, Model::kMeasurements, 1>;
  constexpr bool by_polar = std::is_same_v<Model, RangeBearing<>>;
  std::vector<Measured> measured;
  for (const Eigen::Vector2d& z : positions())
    measured.push_back(Measured((by_polar ? polar(z) : z).template head<Model::kMeasurements>()));
  typename Filter::State x0 = Filter::State::Zero();
  if constexpr (Filter::kStates == 4) x0 << 5000.0, 20000.0, 0.0, 200.0;
  const typename Filter::Covariance P0 = 1e4 * Filter::Covariance::Identity();
  count(name, kSteps, [&] {
    Filter filter(x0, P0);
    for (const Measured& z : measured) {
      filter.predict(motion, 1.0);
      keep(filter.update(model, z));
    }
    keep(filter);
  });
}

void imm6() {
  const std::vector<Eigen::Vector2d> z = positions();
  const std::unique_ptr<TrackedState> state = six_models();
  const Eigen::Vector4d x0(5000.0, 20000.0, 0.0, 200.0);
  const Eigen::Matrix4d P0 = Eigen::Vector4d(1e4, 1e4, 2e4, 2e4).asDiagonal();
  StateUpdate update;
  count("imm6", kSteps, [&] {
    state->begin(x0.data(), P0.data());
    for (const Eigen::Vector2d& value : z) {
      state->predict(1.0);
      keep(state->update(ErasedMeasurement<Position<2>>(kPosition, value, true), update));
    }
  });
}

template <typename Stepped>
void steps(const char* name, Stepped& stepped) {
  const std::vector<Measurement> measurements = stream();
  count(name, kSteps, [&] {
    stepped.reset();
    for (const Measurement& measurement : measurements) stepped.step(measurement);
  });
}

void recurrent() {
  const GatedRecurrent asked = network(32, 0);
  const Eigen::MatrixXd rows = spread(kFeatures, kRows, 1.0).cast<double>();
  count("gru_32", kRows, [&] {
    NetworkMemory h = NetworkMemory::Zero(asked.memory());
    NetworkAnswer answer;
    for (Eigen::Index row = 0; row < kRows; ++row) asked.answer(rows.col(row), h, answer);
    keep(answer);
  });
}

Recording scenario(const char* name) {
  return load_scenario(std::string(TRUEBEARING_SOURCE_DIR "/data/scenarios/") + name)->simulate({});
}

void tma() {
  BearingWindow window;
  for (const Measurement& measurement : scenario("cho_s1.toml").measurements)
    if (!measurement.is_missing() && window.size() < 60)
      window.add(measurement.time_s, measurement.z[0], measurement.sigma[0], measurement.sensor->position_m);
  BatchEstimate estimate;
  count("tma_225_starts", 1, [&] { estimate = solve_cho(window, {}); });
  TargetMotionBatch batch({.start_ranges_m = {6000.0}});
  count("tma_one_start", 1, [&] { estimate = batch.solve(window); });
}

// An interval is a step.
void array(const char* name, Tracker& tracker) {
  const Recording recording = scenario("array_a_10db.toml");
  count(name, static_cast<int>(recording.measurements.size()), [&] {
    tracker.reset();
    for (const Measurement& measurement : recording.measurements) tracker.step(measurement);
  });
}

void arrays() {
  constexpr double kSquareDegree = radians(1.0) * radians(1.0);
  SubspaceAngleOptions papers;
  papers.targets = 5;
  papers.q_rad2ps3 = kSquareDegree;
  papers.sigma_rad = radians(2.0);
  SubspaceAngleTracker subspace(papers);
  array("array_paper", subspace);
  JointAngleOptions options;
  options.targets = 5;
  options.hypotheses.beam = 8;
  options.hypotheses.motion.q0 = options.hypotheses.motion.q_low = 0.001 * kSquareDegree;
  options.hypotheses.motion.q_high = kSquareDegree;
  options.hypotheses.motion.log_power_variance_per_s = 0.001;
  options.rate_sigma_radps = radians(2.0);
  options.noise_power = 1.0;
  JointAngleTracker joint(options);
  array("array_joint", joint);
}

// A step of a thousand particles.
void particles() {
  constexpr int kParticleSteps = 20;
  using D = Distribution;
  PlanarFlightParameters made;
  made.flight.leg_s = {D::Kind::uniform, {10.0, 40.0}};
  made.flight.turn_s = {D::Kind::uniform, {8.0, 30.0}};
  made.flight.turn_rate_degps = {D::Kind::uniform, {1.0, 6.0}};
  const FlightModes modes(made.flight);
  const std::vector<Eigen::Vector2d> z = positions();
  const Eigen::Matrix2d R = kSigma_m * kSigma_m * Eigen::Matrix2d::Identity();
  ParticleCloud now(1000), next(1000);
  count("particles_1000", kParticleSteps, [&] {
    RandomStream stream({}, StreamId::test);
    now.begin(modes, z[0], R, 0.0, stream);
    for (std::size_t k = 1; k <= kParticleSteps; ++k) {
      next.move(now, modes, 1.0, stream);
      keep(next.update(z[k], R));
      now.resample(next, stream);
    }
  });
}

void all() {
  filter<KalmanFilter<2>>("joseph_2_1", ConstantVelocity<1, DiscreteWhiteNoise>{{8.0}},
                          Position<1>{Eigen::Matrix<double, 1, 1>::Constant(kSigma_m)});
  filter<KalmanFilter<4>>("joseph_4_2", kCv, kPosition);
  filter<KalmanFilter<4, Conventional>>("conventional_4_2", kCv, kPosition);
  filter<KalmanFilter<4, SquareRoot>>("square_root_4_2", kCv, kPosition);
  filter<KalmanFilter<4>>("extended_polar", kCv, kPolar);
  filter<UnscentedKalmanFilter<4>>("unscented_linear", kCv, kPosition);
  filter<UnscentedKalmanFilter<4>>("unscented_polar", kCv, kPolar);
  imm6();
  const std::unique_ptr<Tracker> tracker = cv_tracker(8.0);
  steps("tracker", *tracker);
  CorrectedTracker corrected(ensemble(), std::make_shared<const CorrectionModel>(model(32)),
                             {.referee = RefereeOptions{}});
  steps("corrected_32_rules", corrected);
  recurrent();
  tma();
  arrays();
  particles();
}

}  // namespace
}  // namespace truebearing::bench

int main(int count, char** arguments) {
#if defined(__clang__)
  std::printf("clang %d\n", __clang_major__);
#else
  std::printf("g++ %d\n", __GNUC__);
#endif
  if (count > 1 && std::strcmp(arguments[1], "--compiler") == 0) return 0;
  truebearing::bench::all();
  return 0;
}
