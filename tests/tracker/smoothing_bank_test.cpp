// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tracker/smoothing_bank.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>
#include <vector>

#include "tests/support/line_trackers.hpp"
#include "truebearing/tracker/smoothing_tracker.hpp"

namespace truebearing::smoothing_bank_test {
namespace {

using testing::radar_bank;
using testing::radar_log;
using testing::RadarFilter;

constexpr double kRounding = 1e-9;

// A log with rows that are missing, repeated and late.
std::vector<Measurement> rough_log() {
  std::vector<Measurement> log = radar_log(6, 40);
  for (const std::size_t k : {0u, 7u, 8u, 20u, 39u}) log[k].z[0] = kNaN;
  Measurement late = log[5];
  late.z[0] += 3.0;
  log.insert(log.begin() + 11, {log[10], late});
  return log;
}

std::vector<RadarFilter> hypotheses() {
  RadarFilter slow, fast, vague;
  slow.variance = fast.variance = vague.variance = {1e6, 1e4};
  slow.x0 = {0.0, 0.0};
  fast.x0 = {500.0, 150.0};
  vague.sigma_m = 2e3;
  vague.noise_variance = {50.0, 2.0};
  return {slow, fast, vague};
}

std::vector<StepRecord> records_of(Tracker& tracker, const std::vector<Measurement>& log) {
  tracker.reset();
  tracker.foresee(log);
  std::vector<StepRecord> records;
  for (const Measurement& measurement : log) {
    const auto now = tracker.step(measurement);
    records.push_back(now.empty() ? StepRecord{} : now.front());
  }
  return records;
}

std::vector<StepRecord> smoothed_one(const RadarFilter& radar, const std::vector<Measurement>& log,
                                     double lag_s = kInfinity) {
  SmoothingTracker tracker(radar.tracker(), lag_s);
  return records_of(tracker, log);
}

// ln p(all measurements) of one filter, up to what all share.
double log_likelihood(const RadarFilter& radar, const std::vector<Measurement>& log) {
  const auto tracker = radar.tracker();
  double sum = 0.0;
  for (const Measurement& measurement : log)
    if (const StepRecord record = tracker->step(measurement).front(); record.innovation)
      sum -= 0.5 * (record.innovation->nis + std::log(record.innovation->S(0, 0)));
  return sum;
}

TEST(SmoothingBank, OfOneHypothesisIsThatFiltersSmoother) {
  const std::vector<Measurement> log = rough_log();
  const RadarFilter radar = hypotheses()[1];
  for (const double lag_s : {kInfinity, 4.0}) {
    SmoothingBank bank(radar_bank({radar}), lag_s);
    const std::vector<StepRecord> records = records_of(bank, log), wanted = smoothed_one(radar, log, lag_s);
    for (std::size_t k = 0; k < log.size(); ++k) {
      EXPECT_EQ(records[k].status, wanted[k].status) << k;
      EXPECT_LT((records[k].x - wanted[k].x).norm(), kRounding * (1.0 + wanted[k].x.norm())) << k;
      EXPECT_LT((records[k].P - wanted[k].P).norm(), kRounding * wanted[k].P.norm()) << k;
    }
    EXPECT_EQ(bank.counts().repeated, 1);
    EXPECT_EQ(bank.counts().out_of_order, 1);
  }
}

// Each hypothesis by itself, weighted by how probable all measurements make it: moments of the exact mixture.
TEST(SmoothingBank, IsTheMixtureOfSmoothersByTheirFinalWeights) {
  const std::vector<Measurement> log = rough_log();
  const std::vector<RadarFilter> all = hypotheses();
  std::vector<std::vector<StepRecord>> each;
  std::vector<double> weights;
  double total = 0.0;
  const double shared = log_likelihood(all[0], log);
  for (const RadarFilter& radar : all) {
    each.push_back(smoothed_one(radar, log));
    weights.push_back(std::exp(log_likelihood(radar, log) - shared));
    total += weights.back();
  }
  SmoothingBank bank(radar_bank(all));
  const std::vector<StepRecord> records = records_of(bank, log);
  int counted = 0;
  for (std::size_t k = 0; k < log.size(); ++k) {
    if (records[k].status == StepStatus::rejected) continue;
    BoundedVector x = BoundedVector::Zero(2);
    BoundedMatrix P = BoundedMatrix::Zero(2, 2);
    for (std::size_t i = 0; i < all.size(); ++i) x += weights[i] / total * each[i][k].x;
    for (std::size_t i = 0; i < all.size(); ++i) {
      const BoundedVector d = each[i][k].x - x;
      P += weights[i] / total * (each[i][k].P + d * d.transpose());
    }
    EXPECT_LT((records[k].x - x).norm(), 1e-7 * (1.0 + x.norm())) << k;
    EXPECT_LT((records[k].P - P).norm(), 1e-7 * P.norm()) << k;
    ++counted;
  }
  EXPECT_EQ(counted, 40);
}

TEST(SmoothingBank, ALagUsesWhatIsMeasuredUntilThenAndAsLongAsTheRunIsTheInterval) {
  const std::vector<Measurement> log = radar_log(5, 40);
  SmoothingBank interval(radar_bank(hypotheses())), long_lag(radar_bank(hypotheses()), 100.0),
      lag(radar_bank(hypotheses()), 5.0);
  const std::vector<StepRecord> a = records_of(interval, log), b = records_of(long_lag, log), c = records_of(lag, log);
  for (std::size_t k = 0; k < log.size(); ++k) EXPECT_EQ(a[k].x, b[k].x) << k;
  for (const std::size_t changed : {15u, 16u}) {
    std::vector<Measurement> other = log;
    other[changed].z[0] += 1e4;
    EXPECT_EQ(records_of(lag, other)[10].x == c[10].x, changed == 16u) << "the sixth measurement is beyond the lag";
  }
  EXPECT_LT(a[10].P(0, 0), c[10].P(0, 0));
}

TEST(SmoothingBank, NotToldOfTheRunIsTheBankAndItsCopyDoesTheSame) {
  const std::vector<Measurement> log = radar_log(1, 30);
  const auto plain = radar_bank(hypotheses());
  SmoothingBank tracker(radar_bank(hypotheses()));
  for (const Measurement& measurement : log)
    EXPECT_EQ(tracker.step(measurement).front().x, plain->step(measurement).front().x);
  EXPECT_EQ(tracker.account(), nullptr);
  const std::vector<StepRecord> first = records_of(tracker, log), again = records_of(*tracker.fresh(), log);
  for (std::size_t k = 0; k < log.size(); ++k) EXPECT_EQ(first[k].x, again[k].x);
  EXPECT_TRUE(tracker.step(log.back()).empty()) << "more steps than were foretold";
}

TEST(SmoothingBank, AccountsForWhatTheBankKnew) {
  const std::vector<Measurement> log = radar_log(2, 20);
  SmoothingBank tracker(radar_bank(hypotheses()));
  const auto plain = radar_bank(hypotheses());
  tracker.foresee(log);
  for (std::size_t k = 0; k < log.size(); ++k) {
    const StepRecord expected = plain->step(log[k]).front();
    tracker.step(log[k]);
    ASSERT_NE(tracker.account(), nullptr);
    EXPECT_EQ(tracker.account()->filter_variance, expected.P.diagonal());
    EXPECT_EQ(tracker.account()->looked_back, k + 1 < log.size());
  }
  EXPECT_THROW(SmoothingBank(radar_bank(hypotheses()), 0.0), std::invalid_argument);
}

}  // namespace
}  // namespace truebearing::smoothing_bank_test
