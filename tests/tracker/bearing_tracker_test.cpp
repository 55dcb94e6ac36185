// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "tests/support/bearing_trackers.hpp"
#include "truebearing/core/constants.hpp"
#include "truebearing/core/covariance.hpp"

namespace truebearing::bearing_tracker_test {
namespace {

using testing::bearing_tracker;
using testing::bearings_run;
using testing::guessed_range;

TEST(BearingSensor, TakesPositionAndDeviationFromTheMeasurement) {
  const BearingSensor sensor{0.02, 2.0};
  Measurement measurement;
  measurement.z = BoundedVector::Constant(1, 1.0);
  const Bearing<> silent = sensor.model(measurement);
  EXPECT_EQ(silent.site_m, Eigen::Vector2d::Zero());
  EXPECT_EQ(silent.site_velocity_mps, Eigen::Vector2d::Zero());
  EXPECT_EQ(silent.sigma_rad, 0.04);
  measurement.sigma = BoundedVector::Constant(1, 0.01);
  measurement.sensor = SensorState{{1.0, 2.0}, {3.0, 4.0}};
  const Bearing<> told = sensor.model(measurement);
  EXPECT_EQ(told.site_m, Eigen::Vector2d(1.0, 2.0));
  EXPECT_EQ(told.site_velocity_mps, Eigen::Vector2d(3.0, 4.0));
  EXPECT_EQ(told.sigma_rad, 0.02);
}

TEST(BearingTracker, BeginsWithTheFirstBearingWhereThePriorIs) {
  const auto tracker = bearing_tracker<KalmanFilter<4>>();
  const Measurement first = bearings_run(1).measurements[0];
  const auto records = tracker->step(first);
  ASSERT_EQ(records.size(), 1u);
  const GaussianState prior = guessed_range().state(first.z[0], first.sigma[0], *first.sensor, first.guess);
  EXPECT_EQ(records[0].status, StepStatus::ok);
  EXPECT_EQ(records[0].x, prior.x);
  EXPECT_LT((records[0].P - prior.P).norm(), 1e-12 * prior.P.norm());
  EXPECT_FALSE(records[0].innovation) << "nothing was predicted";
}

TEST(BearingTracker, WaitsForABearingAndForAGuess) {
  std::vector<Measurement> log = bearings_run(1).measurements;
  const auto tracker = bearing_tracker<KalmanFilter<4>>();
  for (int k = 0; k < 3; ++k) {
    Measurement silent = log[static_cast<std::size_t>(k)];
    silent.guess.reset();
    EXPECT_TRUE(tracker->step(silent).empty()) << "no guess yet";
  }
  Measurement guess = log[3];
  guess.z[0] = kNaN;
  guess.guess = TargetGuess{.range_m = 4321.0, .range_sigma_m = 100.0};
  EXPECT_TRUE(tracker->step(guess).empty()) << "a guess, and no bearing";
  const auto records = tracker->step(log[4]);
  ASSERT_EQ(records.size(), 1u);
  EXPECT_NEAR((records[0].x.head<2>() - log[4].sensor->position_m).norm(), 4321.0, 1e-9);
  tracker->reset();
  log[0].guess.reset();
  EXPECT_TRUE(tracker->step(log[0]).empty()) << "the guess was of another run";
}

TEST(BearingTracker, BearingWithoutADeviationStartsNothing) {
  std::vector<Measurement> log = bearings_run(1).measurements;
  log[0].sigma[0] = kNaN;
  const auto tracker = bearing_tracker<LogPolarFilter<>>();
  EXPECT_TRUE(tracker->step(log[0]).empty());
  EXPECT_EQ(tracker->counts().failed, 1);
  EXPECT_EQ(tracker->step(log[1]).size(), 1u);
}

TEST(BearingTracker, LostTargetBeginsAnewWithTheSameBelief) {
  const std::vector<Measurement> log = bearings_run(2).measurements;
  const auto tracker = bearing_tracker<KalmanFilter<4>>({.lost_after_s = 60.0});
  for (int k = 0; k < 20; ++k) EXPECT_EQ(tracker->step(log[static_cast<std::size_t>(k)])[0].track, 0);
  const Measurement& later = log[40];
  const auto records = tracker->step(later);
  ASSERT_EQ(records.size(), 1u);
  EXPECT_EQ(records[0].track, 1);
  EXPECT_NEAR((records[0].x.head<2>() - later.sensor->position_m).norm(), log[0].guess->range_m, 1e-9);
}

template <typename Make>
void expect_it_begins_anew(const Make& make) {
  const auto tracker = make(), fresh = make();
  for (const Measurement& measurement : bearings_run(5).measurements) tracker->step(measurement);
  const auto copy = tracker->fresh();
  tracker->reset();
  for (const Measurement& measurement : bearings_run(6).measurements) {
    const StepRecord record = fresh->step(measurement)[0];
    for (Tracker* other : {tracker.get(), copy.get()}) {
      const StepRecord same = other->step(measurement)[0];
      ASSERT_EQ(same.x, record.x);
      ASSERT_EQ(same.P, record.P);
    }
  }
}

TEST(BearingTracker, ResetAndFreshBeginAnew) {
  expect_it_begins_anew([] { return bearing_tracker<LogPolarFilter<>>(); });
  expect_it_begins_anew([] { return testing::range_bank({guessed_range(), 5, 4}); });
}

template <typename Make>
void expect_missing_bearings_leave_no_trace(const Make& make) {
  const auto tracker = make(), clean = make();
  int missing = 0;
  for (const Measurement& measurement : bearings_run(9).measurements) {
    const auto without = clean->step(measurement), with = tracker->step(measurement);
    ASSERT_EQ(with[0].x, without[0].x);
    ASSERT_EQ(with[0].P, without[0].P);
    Measurement empty = measurement;
    empty.time_s += 3.0;
    empty.z[0] = kNaN;
    EXPECT_EQ(tracker->step(empty)[0].status, StepStatus::coasted);
    ++missing;
  }
  EXPECT_EQ(tracker->counts().missing, missing);
}

TEST(BearingTracker, MissingBearingsLeaveNoTrace) {
  expect_missing_bearings_leave_no_trace([] { return bearing_tracker<LogPolarFilter<>>(); });
  expect_missing_bearings_leave_no_trace([] { return testing::range_bank({guessed_range(), 5, 4}); });
}

TEST(BearingTracker, HostileStreamNeverGivesAnInvalidRecord) {
  RandomStream random({.seed = 98}, StreamId::test);
  const double values[] = {kNaN, 1e308, -1e308, 0.0, 3.1, -3.1, 1e-308, 50.0};
  const double sigmas[] = {kNaN, 0.0, -1.0, 1e-12, 1e200, 0.02};
  for (const auto& tracker : {bearing_tracker<KalmanFilter<4>>(), bearing_tracker<LogPolarFilter<>>(),
                              testing::range_bank({guessed_range(), 4, 3})})
    for (std::uint64_t run = 0; run < 20; ++run) {
      tracker->reset();
      for (Measurement measurement : bearings_run(run).measurements) {
        if (random.uniform() < 0.3) measurement.z[0] = values[random.index(8)];
        if (random.uniform() < 0.2) measurement.sigma[0] = sigmas[random.index(6)];
        if (random.uniform() < 0.1) measurement.sensor.reset();
        for (const StepRecord& record : tracker->step(measurement)) {
          ASSERT_TRUE(record.x.allFinite());
          ASSERT_TRUE(is_covariance(record.P)) << record.P;
        }
      }
    }
}

}  // namespace
}  // namespace truebearing::bearing_tracker_test
