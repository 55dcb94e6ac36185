// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tracker/particle_limit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

#include "tests/support/statistics.hpp"
#include "truebearing/core/angle.hpp"
#include "truebearing/core/constants.hpp"
#include "truebearing/core/linear_algebra.hpp"
#include "truebearing/simulation/planar_flight_scenario.hpp"
#include "truebearing/tracker/bearing_sensor.hpp"
#include "truebearing/tracker/polar_sensor.hpp"
#include "truebearing/tracker/position_sensor.hpp"

namespace truebearing::particle_limit_test {
namespace {

constexpr double kSigma_m = 100.0;

PlanarFlightParameters family(int steps) {
  using D = Distribution;
  PlanarFlightParameters made;
  made.steps = steps;
  made.flight.speed_mps = {D::Kind::uniform, {150.0, 350.0}};
  made.flight.first_leg_s = D(D::Kind::uniform, {10.0, 30.0});
  made.flight.leg_s = {D::Kind::uniform, {10.0, 40.0}};
  made.flight.turn_s = {D::Kind::uniform, {8.0, 30.0}};
  made.flight.turn_rate_degps = {D::Kind::uniform, {1.0, 6.0}};
  made.flight.roll_in_s = 0.0;
  made.flight.acceleration_share = 0.3;
  made.flight.acceleration_s = {D::Kind::uniform, {8.0, 10.0}};
  made.flight.acceleration_mps2 = {D::Kind::uniform, {5.0, 30.0}};
  made.flight.lowest_speed_mps = 80.0;
  made.flight.highest_speed_mps = 500.0;
  made.sensor.sigma_m = kSigma_m;
  return made;
}

Recording recording(const PlanarFlightParameters& parameters, std::uint64_t run) {
  return PlanarFlightScenario(parameters).simulate({1, Role::evaluation, run});
}

ParticleLimit limit(const PlanarFlightParameters& parameters, int particles, double sigma_m = kSigma_m,
                    std::uint64_t seed = 1) {
  ParticleLimitOptions options;
  options.flight = parameters.flight;
  options.particles = particles;
  options.seed = seed;
  options.flight_s = parameters.steps * parameters.period_s;
  return {sensor_of(PositionSensor<2>{{sigma_m, sigma_m}}), options};
}

/// The line that fits the first `count` measurements best, at the last of them: [position, velocity] (4) and
/// covariance.
GaussianState best_line(const Recording& log, int count) {
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
  Eigen::Matrix2d sums = Eigen::Matrix2d::Zero();  // a column for each axis
  const double end_s = log.measurements[static_cast<std::size_t>(count - 1)].time_s;
  for (int k = 0; k < count; ++k) {
    const Measurement& m = log.measurements[static_cast<std::size_t>(k)];
    const Eigen::Vector2d row(1.0, m.time_s - end_s);
    information += row * row.transpose() / (kSigma_m * kSigma_m);
    sums += row * m.z.transpose() / (kSigma_m * kSigma_m);
  }
  const Eigen::Matrix2d P = inverse_of_positive<2>(information), line = P * sums;
  GaussianState state{Eigen::Vector4d::Zero(), Eigen::Matrix4d::Zero()};
  state.x << line(0, 0), line(0, 1), line(1, 0), line(1, 1);
  for (int axis = 0; axis < 2; ++axis)
    for (int i = 0; i < 2; ++i)
      for (int j = 0; j < 2; ++j) state.P(axis + 2 * i, axis + 2 * j) = P(i, j);
  return state;
}

// A target that never turns, of a speed that is hardly known: nothing is left but the linear problem. What is left of
// the start's granularity is far below the filter's own deviation.
TEST(ParticleLimit, WithoutManoeuvresIsTheKalmanFilter) {
  PlanarFlightParameters quiet = family(60);
  quiet.flight.speed_mps = {Distribution::Kind::uniform, {1.0, 700.0}};
  quiet.flight.quiet_share = 1.0;
  constexpr double kMonteCarlo = 0.02;  // of a squared Mahalanobis distance, whose mean is 4 between estimate and truth
  for (std::uint64_t run = 0; run < 5; ++run) {
    const Recording log = recording(quiet, run);
    ParticleLimit tracker = limit(quiet, 4000);
    for (int k = 1; k <= 60; ++k) {
      const StepRecord& record = tracker.step(log.measurements[static_cast<std::size_t>(k - 1)])[0];
      EXPECT_EQ(record.status, StepStatus::ok);
      if (k < 20) continue;
      const GaussianState line = best_line(log, k);
      const Eigen::Vector4d difference = record.x - line.x;
      EXPECT_LT(difference.dot(inverse_of_positive<4>(line.P) * difference), kMonteCarlo) << "step " << k;
      EXPECT_NEAR(record.P(0, 0) / line.P(0, 0), 1.0, 0.05) << "step " << k;
      EXPECT_NEAR(record.P(2, 2) / line.P(2, 2), 1.0, 0.1) << "step " << k;
    }
    EXPECT_EQ(tracker.fresh_starts(), 0);
  }
}

TEST(ParticleLimit, SameSeedGivesTheSameBits) {
  const Recording log = recording(family(40), 3);
  ParticleLimit one = limit(family(40), 500), other_seed = limit(family(40), 500, kSigma_m, 2);
  const std::unique_ptr<Tracker> fresh = one.fresh();
  std::vector<BoundedVector> first;
  bool differs = false;
  for (const Measurement& m : log.measurements) {
    first.push_back(one.step(m)[0].x);
    EXPECT_EQ(fresh->step(m)[0].x, first.back());
    differs |= other_seed.step(m)[0].x != first.back();
  }
  EXPECT_TRUE(differs);
  one.reset();
  for (std::size_t k = 0; k < first.size(); ++k) EXPECT_EQ(one.step(log.measurements[k])[0].x, first[k]);
}

struct Errors {
  double squared_m2 = 0.0;
  double nees = 0.0;  // sum over runs of the mean over steps
  std::vector<double> run_m2;
};

Errors errors(int particles, double sigma_m, int runs) {
  constexpr std::size_t kFrom = 7;
  const PlanarFlightParameters parameters = family(60);
  ParticleLimit tracker = limit(parameters, particles, sigma_m);
  Errors all;
  for (int run = 0; run < runs; ++run) {
    const Recording log = recording(parameters, static_cast<std::uint64_t>(run));
    tracker.reset();
    double m2 = 0.0, nees = 0.0;
    for (std::size_t k = 0; k < log.measurements.size(); ++k) {
      const StepRecord& record = tracker.step(log.measurements[k])[0];
      if (k < kFrom) continue;
      const Eigen::Vector4d error = record.x - log.truth[0].x[k];
      const Eigen::Matrix4d P = record.P;
      const double steps = static_cast<double>(log.measurements.size() - kFrom);
      m2 += error.head<2>().squaredNorm() / steps;
      nees += error.dot(inverse_of_positive<4>(P) * error) / steps;
    }
    all.run_m2.push_back(m2);
    all.squared_m2 += m2 / runs;
    all.nees += nees;
  }
  return all;
}

// A run counts as one: its steps depend on each other.
TEST(ParticleLimit, KnowsHowGoodItIs) {
  constexpr int kRuns = 40;
  const double nees = errors(4000, kSigma_m, kRuns).nees;
  EXPECT_FALSE(testing::is_too_large(nees, 4.0 * kRuns)) << nees / kRuns;
  EXPECT_FALSE(testing::is_too_small(nees, 4.0 * kRuns)) << nees / kRuns;
  const double mistuned = errors(4000, 0.5 * kSigma_m, kRuns).nees;
  EXPECT_TRUE(testing::is_too_large(mistuned, 4.0 * kRuns)) << mistuned / kRuns << ": the test sees no difference";
}

TEST(ParticleLimit, MoreParticlesChangeLittle) {
  constexpr int kRuns = 40;
  const Errors few = errors(3000, kSigma_m, kRuns), many = errors(6000, kSigma_m, kRuns);
  std::vector<double> differences;
  for (std::size_t run = 0; run < kRuns; ++run) differences.push_back(few.run_m2[run] - many.run_m2[run]);
  const testing::Moments difference = testing::moments(differences);
  const double margin = testing::mean_margin(std::sqrt(difference.variance), kRuns);
  EXPECT_LT(difference.mean - margin, 0.05 * many.squared_m2) << std::sqrt(few.squared_m2);
  EXPECT_GT(difference.mean + margin, -0.01 * many.squared_m2) << "more particles are worse";
  EXPECT_LT(std::sqrt(many.squared_m2), 0.8 * kSigma_m) << "the measurement has sqrt(2) of it";
}

// Not of the family: at 1000 m/s it is where no particle could have come.
TEST(ParticleLimit, FindsATargetThatItHadLost) {
  const PlanarFlightParameters parameters = family(60);
  Recording log = recording(parameters, 0);
  constexpr std::size_t kJump = 30;
  for (std::size_t k = kJump; k < log.measurements.size(); ++k) log.measurements[k].z[0] += 20e3;
  ParticleLimit tracker = limit(parameters, 4000);
  for (std::size_t k = 0; k < log.measurements.size(); ++k) {
    const StepRecord& record = tracker.step(log.measurements[k])[0];
    EXPECT_NE(record.status, StepStatus::failed);
    if (k < kJump + 10) continue;
    EXPECT_LT(std::hypot(record.x[0] - 20e3 - log.truth[0].x[k][0], record.x[1] - log.truth[0].x[k][1]), 500.0);
  }
  EXPECT_GT(tracker.fresh_starts(), 0);
  EXPECT_LT(tracker.fresh_starts(), 10);
}

TEST(ParticleLimit, MissingMeasurementLeavesNoTrace) {
  const Recording log = recording(family(40), 1);
  ParticleLimit with = limit(family(40), 500), without = limit(family(40), 500);
  for (std::size_t k = 0; k < log.measurements.size(); ++k) {
    const Measurement& m = log.measurements[k];
    const BoundedVector x = without.step(m)[0].x;
    EXPECT_EQ(with.step(m)[0].x, x);
    Measurement missing = m;
    missing.time_s += 0.5;
    missing.z.setConstant(kNaN);
    const StepRecord& coasted = with.step(missing)[0];
    EXPECT_EQ(coasted.status, StepStatus::coasted);
    EXPECT_TRUE(coasted.x.allFinite());
    EXPECT_FALSE(coasted.innovation);
    Measurement late = m;
    late.time_s -= 1.0;
    EXPECT_EQ(with.step(late)[0].status, StepStatus::rejected);
  }
  EXPECT_EQ(with.counts().missing, 40);
}

TEST(ParticleLimit, HostileValuesAreNoEstimates) {
  const Recording log = recording(family(40), 1);
  ParticleLimit tracker = limit(family(40), 200);
  for (std::size_t k = 0; k < log.measurements.size(); ++k) {
    Measurement m = log.measurements[k];
    if (k % 5 == 3) m.z[0] = 1e300;
    if (k % 7 == 3) m.time_s += 1e9;
    for (const StepRecord& record : tracker.step(m)) {
      EXPECT_TRUE(record.x.allFinite());
      EXPECT_TRUE(record.P.allFinite());
    }
  }
}

TEST(ParticleLimit, RecordsSayWhatItDid) {
  const Recording log = recording(family(40), 2);
  ParticleLimit tracker = limit(family(40), 500);
  EXPECT_FALSE(tracker.step(log.measurements[0])[0].innovation) << "it begins with the first measurement";
  for (std::size_t k = 1; k < log.measurements.size(); ++k) {
    const StepRecord& record = tracker.step(log.measurements[k])[0];
    ASSERT_TRUE(record.innovation && record.prediction && record.mode_probabilities);
    EXPECT_NEAR(record.mode_probabilities->sum(), 1.0, 1e-12);
    EXPECT_EQ(record.mode_probabilities->size(), 3);
    const Eigen::Vector2d nu = log.measurements[k].z - record.prediction->x.head<2>();
    EXPECT_TRUE(nu.isApprox(Eigen::Vector2d(record.innovation->nu)));
    EXPECT_TRUE(record.P.isApprox(record.P.transpose(), 1e-12));
    Eigen::Matrix4d L;
    EXPECT_TRUE(cholesky(Eigen::Matrix4d(record.P), L));
  }
}

// Range and bearing: the same target seen sharply in range and badly across.
TEST(ParticleLimit, TakesConvertedRangesAndBearings) {
  PlanarFlightParameters parameters = family(60);
  parameters.site = SiteAtRange{20e3, 30};
  parameters.sensor.output = &planar_output("range_bearing");
  parameters.sensor.sigma_m = 50.0;
  parameters.sensor.further_sigma = BoundedVector::Constant(1, radians(0.3));
  ParticleLimitOptions options;
  options.flight = parameters.flight;
  options.particles = 4000;
  ParticleLimit tracker(sensor_of(ConvertedSensor{PolarSensor{{50.0, radians(0.3)}}}), options);
  double squared_m2 = 0.0, steps = 0.0;
  for (std::uint64_t run = 0; run < 10; ++run) {
    const Recording log = recording(parameters, run);
    tracker.reset();
    for (std::size_t k = 0; k < log.measurements.size(); ++k) {
      const StepRecord& record = tracker.step(log.measurements[k])[0];
      if (k < 7) continue;
      squared_m2 += (record.x - log.truth[0].x[k]).head<2>().squaredNorm();
      steps += 1.0;
    }
  }
  EXPECT_LT(std::sqrt(squared_m2 / steps), 85.0) << "the measurement has 116 m";
}

TEST(ParticleLimit, WantsPositionsInThePlane) {
  ParticleLimitOptions options;
  EXPECT_THROW(ParticleLimit(sensor_of(PositionSensor<1>{}), options), std::invalid_argument);
  EXPECT_THROW(ParticleLimit(sensor_of(BearingSensor{}), options), std::invalid_argument);
  options.particles = 0;
  EXPECT_THROW(ParticleLimit(sensor_of(PositionSensor<2>{}), options), std::invalid_argument);
}

}  // namespace
}  // namespace truebearing::particle_limit_test
