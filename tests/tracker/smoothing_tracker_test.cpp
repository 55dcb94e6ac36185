// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tracker/smoothing_tracker.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <memory>
#include <stdexcept>
#include <vector>

#include "tests/support/line_trackers.hpp"
#include "tests/support/plane_trackers.hpp"
#include "truebearing/core/chi_square.hpp"
#include "truebearing/core/constants.hpp"

namespace truebearing::smoothing_tracker_test {
namespace {

using testing::kPlaneSensor;
using testing::PlaneMotion;
using testing::position;
using testing::radar_log;
using testing::RadarFilter;

std::unique_ptr<FilterTracker> as_filter(std::unique_ptr<Tracker> tracker) {
  return std::unique_ptr<FilterTracker>(dynamic_cast<FilterTracker*>(tracker.release()));
}

std::unique_ptr<FilterTracker> filter(FilterTrackerOptions options = {}) {
  RadarFilter radar;
  radar.options = options;
  return as_filter(radar.tracker());
}

// One record per measurement; a record without x where there was none.
std::vector<StepRecord> records_of(Tracker& tracker, const std::vector<Measurement>& log, bool foreseen = true) {
  tracker.reset();
  if (foreseen) tracker.foresee(log);
  std::vector<StepRecord> records;
  for (const Measurement& measurement : log) {
    const auto now = tracker.step(measurement);
    records.push_back(now.empty() ? StepRecord{} : now.front());
  }
  return records;
}

std::vector<StepRecord> smoothed(const std::vector<Measurement>& log, FilterTrackerOptions options = {},
                                 double lag_s = kInfinity) {
  SmoothingTracker tracker(filter(options), lag_s);
  return records_of(tracker, log);
}

void expect_same(const std::vector<StepRecord>& a, const std::vector<StepRecord>& b, std::size_t count) {
  for (std::size_t k = 0; k < count; ++k) {
    EXPECT_EQ(a[k].x, b[k].x) << k;
    EXPECT_EQ(a[k].P, b[k].P) << k;
    EXPECT_EQ(a[k].track, b[k].track) << k;
    EXPECT_EQ(a[k].status, b[k].status) << k;
    EXPECT_EQ(a[k].time_s, b[k].time_s) << k;
  }
}

TEST(SmoothingTracker, KnowsMoreThanItsFilterAndAsMuchAtTheEnd) {
  const std::vector<Measurement> log = radar_log(0, 60);
  const auto plain = filter();
  const std::vector<StepRecord> filtered = records_of(*plain, log), records = smoothed(log);
  for (std::size_t k = 0; k + 1 < log.size(); ++k) {
    EXPECT_LT(records[k].P(0, 0), filtered[k].P(0, 0)) << k;
    EXPECT_LT(records[k].P(1, 1), filtered[k].P(1, 1)) << k;
    EXPECT_FALSE(records[k].prediction || records[k].innovation || records[k].gain) << "they are the filter's";
  }
  EXPECT_EQ(records.back().x, filtered.back().x);
  EXPECT_EQ(records.back().P, filtered.back().P);
}

TEST(SmoothingTracker, NotToldOfTheRunIsItsFilter) {
  const std::vector<Measurement> log = radar_log(1, 30);
  const auto plain = filter();
  SmoothingTracker tracker(filter());
  expect_same(records_of(tracker, log, false), records_of(*plain, log), log.size());
  EXPECT_EQ(tracker.account(), nullptr);
}

TEST(SmoothingTracker, RepeatsItselfAndItsCopyDoesTheSame) {
  const std::vector<Measurement> log = radar_log(2, 30), other = radar_log(3, 40);
  SmoothingTracker tracker(filter());
  const std::vector<StepRecord> first = records_of(tracker, log);
  records_of(tracker, other);
  expect_same(records_of(tracker, log), first, log.size());
  expect_same(records_of(*tracker.fresh(), log), first, log.size());
  EXPECT_TRUE(tracker.step(log.back()).empty()) << "more steps than were foretold";
}

TEST(SmoothingTracker, ALagAsLongAsTheRunIsTheFixedInterval) {
  const std::vector<Measurement> log = radar_log(4, 40);
  expect_same(smoothed(log, {}, 40.0), smoothed(log), log.size());
  SmoothingTracker interval(as_filter(testing::plane_imm())), lag(as_filter(testing::plane_imm()), 100.0);
  std::vector<Measurement> plane;
  RandomStream random({4, Role::evaluation, 0}, StreamId::test);
  for (int k = 0; k < 30; ++k) {
    Measurement measurement;
    measurement.time_s = k;
    const double noise_1 = 100.0 * random.normal(), noise_2 = 100.0 * random.normal();
    measurement.z = Eigen::Vector2d(200.0 * k + noise_1, 3.0 * k * k + noise_2);
    plane.push_back(measurement);
  }
  expect_same(records_of(lag, plane), records_of(interval, plane), plane.size());
  EXPECT_TRUE(records_of(lag, plane)[10].mode_probabilities.has_value());
}

TEST(SmoothingTracker, OfAFixedLagUsesWhatIsMeasuredUntilThen) {
  const std::vector<Measurement> log = radar_log(5, 40);
  const std::vector<StepRecord> records = smoothed(log, {}, 5.0);
  for (const std::size_t changed : {15u, 16u}) {
    std::vector<Measurement> other = log;
    other[changed].z[0] += 1e4;
    const std::vector<StepRecord> then = smoothed(other, {}, 5.0);
    EXPECT_EQ(then[10].x == records[10].x, changed == 16u) << "the sixth measurement after it is beyond the lag";
  }
  std::vector<Measurement> shorter(log.begin(), log.begin() + 16);
  EXPECT_EQ(smoothed(shorter)[10].x, records[10].x) << "it is the fixed interval of what has come by then";
}

// What stands at a missing measurement is what one of infinite variance leaves.
TEST(SmoothingTracker, AMissingMeasurementIsOneThatTellsNothing) {
  std::vector<Measurement> log = radar_log(6, 40), vague = log;
  for (const std::size_t k : {0u, 1u, 7u, 8u, 9u, 20u, 39u}) {
    log[k].z[0] = kNaN;
    vague[k].sigma = BoundedVector::Constant(1, 1e12);
  }
  // A motion whose noise over two intervals is that over both.
  using Motion = ConstantVelocity<1, ContinuousWhiteNoise>;
  const RadarFilter radar;
  const PriorStart prior{radar.x0, radar.variance.asDiagonal().toDenseMatrix(), 0.0};
  SmoothingTracker tracker(std::make_unique<FilterTrackerOf<KalmanFilter<2>, Motion, PositionSensor<1>>>(
      line_space(), Motion{{5.0}}, radar.sensor(), prior));
  const std::vector<StepRecord> missing = records_of(tracker, log), told = records_of(tracker, vague);
  for (std::size_t k = 0; k < log.size(); ++k) {
    EXPECT_EQ(missing[k].status == StepStatus::coasted, std::isnan(log[k].z[0])) << k;
    EXPECT_LE((missing[k].x - told[k].x).norm(), 1e-6 * told[k].x.norm()) << k;
    EXPECT_LE((missing[k].P - told[k].P).norm(), 1e-6 * told[k].P.norm()) << k;
  }
}

TEST(SmoothingTracker, AMeasurementThatTheGateTurnsAwayIsAsMissing) {
  std::vector<Measurement> log = radar_log(7, 40), without = log;
  log[20].z[0] += 1e6;
  without[20].z[0] = kNaN;
  const FilterTrackerOptions gated{.gate_nis = chi_square_quantile(0.999999, 1)};
  const std::vector<StepRecord> records = smoothed(log, gated), expected = smoothed(without, gated);
  EXPECT_EQ(records[20].status, StepStatus::rejected);
  for (std::size_t k = 0; k <= 20; ++k) EXPECT_EQ(records[k].x, expected[k].x) << k;
}

TEST(SmoothingTracker, RowsThatWereNotLookedAtStandAsTheRowBefore) {
  std::vector<Measurement> log = radar_log(8, 20), plain = log;
  Measurement late = log[5];
  late.z[0] += 3.0;
  log.insert(log.begin() + 11, {log[10], late});
  const std::vector<StepRecord> records = smoothed(log), expected = smoothed(plain);
  for (const std::size_t k : {11u, 12u}) {
    EXPECT_EQ(records[k].status, StepStatus::rejected);
    EXPECT_EQ(records[k].x, expected[10].x);
    EXPECT_EQ(records[k].time_s, log[10].time_s);
  }
  EXPECT_EQ(records[13].x, expected[11].x);
  SmoothingTracker tracker(filter());
  records_of(tracker, log);
  EXPECT_EQ(tracker.counts().repeated, 1);
  EXPECT_EQ(tracker.counts().out_of_order, 1);
}

TEST(SmoothingTracker, NeverLooksAcrossTheBeginningOfATrack) {
  const FilterTrackerOptions options{.lost_after_s = 10.0};
  std::vector<Measurement> log = radar_log(9, 20), later = radar_log(10, 20);
  for (Measurement& measurement : later) {
    measurement.time_s += 100.0;
    measurement.z[0] += 5e4;
  }
  std::vector<Measurement> both = log;
  both.insert(both.end(), later.begin(), later.end());
  const std::vector<StepRecord> records = smoothed(both, options), alone = smoothed(log, options);
  expect_same(records, alone, log.size());
  EXPECT_EQ(records.back().track, 1);
  const auto plain = filter(options);
  EXPECT_LT(records[log.size() + 3].P(0, 0), records_of(*plain, both)[log.size() + 3].P(0, 0));
}

// Nor where the first measurement of the new track was turned away.
TEST(SmoothingTracker, NeverLooksAcrossABeginningWithoutAMeasurement) {
  const FilterTrackerOptions options{.gate_nis = chi_square_quantile(0.999999, 1), .lost_after_s = 10.0};
  std::vector<Measurement> log = radar_log(9, 20), later = radar_log(10, 20);
  for (Measurement& measurement : later) measurement.time_s += 100.0;
  later[0].z[0] = 1e6;
  std::vector<Measurement> both = log;
  both.insert(both.end(), later.begin(), later.end());
  const std::vector<StepRecord> records = smoothed(both, options), alone = smoothed(log, options);
  expect_same(records, alone, log.size());
  EXPECT_EQ(records[20].status, StepStatus::rejected);
  EXPECT_EQ(records[20].track, 1);
  const auto plain = filter(options);
  EXPECT_LT(records[20].P(0, 0), records_of(*plain, both)[20].P(0, 0)) << "but it is smoothed by what follows";
}

// A measurement that only a widened gate lets through is smoothed with the noise that this supposes.
TEST(SmoothingTracker, AWidenedGateIsSmoothedAcross) {
  std::vector<Measurement> log = radar_log(11, 40);
  for (std::size_t k = 20; k < log.size(); ++k) log[k].z[0] += 4e4;
  const FilterTrackerOptions gated{.gate_nis = chi_square_quantile(0.99, 1)};
  SmoothingTracker tracker(filter(gated));
  const auto plain = filter(gated);
  const std::vector<StepRecord> records = records_of(tracker, log), filtered = records_of(*plain, log);
  bool widened = false;
  for (std::size_t k = 0; k < log.size(); ++k) {
    ASSERT_EQ(records[k].status, filtered[k].status);
    EXPECT_LE(records[k].P(0, 0), filtered[k].P(0, 0) * (1.0 + 1e-9)) << k;
    plain->reset();
    widened |= records[k].status == StepStatus::rejected;
  }
  EXPECT_TRUE(widened);
}

TEST(SmoothingTracker, AccountsForWhatItsFilterDid) {
  const std::vector<Measurement> log = radar_log(12, 20);
  SmoothingTracker tracker(filter());
  const auto plain = filter();
  tracker.foresee(log);
  for (std::size_t k = 0; k < log.size(); ++k) {
    const StepRecord expected = plain->step(log[k]).front();
    tracker.step(log[k]);
    ASSERT_NE(tracker.account(), nullptr);
    EXPECT_EQ(tracker.account()->filter_variance, expected.P.diagonal());
    EXPECT_EQ(tracker.account()->nis, expected.innovation->nis);
    EXPECT_EQ(tracker.account()->measured, 1);
    EXPECT_EQ(tracker.account()->looked_back, k + 1 < log.size());
  }
}

TEST(SmoothingTracker, IsOfWhatAFilterEstimates) {
  EXPECT_THROW(SmoothingTracker(filter({.output_pull = 0.2})), std::invalid_argument);
  EXPECT_THROW(SmoothingTracker(filter({.ahead_s = 1.0})), std::invalid_argument);
  EXPECT_THROW(SmoothingTracker(filter(), 0.0), std::invalid_argument);
}

}  // namespace
}  // namespace truebearing::smoothing_tracker_test
