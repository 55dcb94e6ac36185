// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tracker/filter_bank.hpp"

#include <gtest/gtest.h>

#include "tests/support/line_trackers.hpp"
#include "tests/support/statistics.hpp"
#include "truebearing/core/constants.hpp"
#include "truebearing/core/covariance.hpp"

namespace truebearing::filter_bank_test {
namespace {

using testing::last_record;
using testing::position;
using testing::radar_bank;
using testing::radar_log;
using testing::RadarFilter;

TEST(FilterBank, OfOneHypothesisIsThatFilter) {
  const RadarFilter radar;
  const auto bank = radar_bank({radar}, {-3.0});
  const auto tracker = radar.tracker();
  for (const Measurement& measurement : radar_log(4, 100)) {
    const StepRecord expected = tracker->step(measurement)[0];
    const StepRecord record = bank->step(measurement)[0];
    ASSERT_LT((record.x - expected.x).norm(), 1e-12 * (1.0 + expected.x.norm()));
    ASSERT_LT((record.P - expected.P).norm(), 1e-12 * expected.P.norm());
  }
}

TEST(FilterBank, EqualHypothesesAddNothing) {
  const RadarFilter radar;
  const auto one = radar_bank({radar});
  const auto three = radar_bank({radar, radar, radar}, {0.0, 2.0, -700.0});
  const StepRecord a = last_record(*one, radar_log(4, 100));
  const StepRecord b = last_record(*three, radar_log(4, 100));
  EXPECT_LT((a.x - b.x).norm(), 1e-12 * a.x.norm());
  EXPECT_LT((a.P - b.P).norm(), 1e-12 * a.P.norm());
}

// Before the first measurement the mixture is the prior's: mean and covariance by hand.
TEST(FilterBank, CovarianceHoldsTheSpreadOfTheMeans) {
  RadarFilter left, right;
  left.x0 = {0.0, -100.0};
  right.x0 = {0.0, 100.0};
  const auto bank = radar_bank({left, right}, {std::log(0.25), std::log(0.75)});
  const StepRecord record = bank->step(position(0.0, kNaN))[0];
  EXPECT_EQ(record.status, StepStatus::coasted);
  EXPECT_NEAR(record.x[1], 50.0, 1e-12);
  EXPECT_NEAR(record.P(1, 1), 999.0 + 0.25 * 150.0 * 150.0 + 0.75 * 50.0 * 50.0, 1e-9);
}

TEST(FilterBank, PosteriorPicksTheMeasurementNoiseThatMadeTheLog) {
  RadarFilter radar;
  radar.variance = {1e6, 5e4};
  for (const double sigma_m : {300.0, 3000.0, 30000.0}) {
    std::vector<RadarFilter> hypotheses;
    for (const double believed : {300.0, 3000.0, 30000.0}) {
      radar.sigma_m = believed;
      hypotheses.push_back(radar);
    }
    const auto bank = radar_bank(hypotheses);
    radar.sigma_m = sigma_m;
    const auto right = radar.tracker();
    RandomStream random({}, StreamId::measurement);
    StepRecord mixture, alone;
    for (int k = 1; k <= 60; ++k) {
      const Measurement measurement = position(k, 150.0 * k + sigma_m * random.normal());
      mixture = bank->step(measurement)[0];
      alone = right->step(measurement)[0];
    }
    EXPECT_LT((mixture.x - alone.x).norm(), 1e-6 * alone.x.norm()) << sigma_m;
    EXPECT_LT((mixture.P - alone.P).norm(), 1e-6 * alone.P.norm()) << sigma_m;
  }
}

// The NEES at the last step of runs whose velocity and noise are drawn from what the bank believes. Its expectation is
// 2 for the Bayes estimate, mixture or not; the interval is that of the mean of `runs` independent values.
testing::Moments bank_nees(const std::vector<double>& believed_factors, std::size_t runs) {
  const std::vector<double> velocities{-300.0, -100.0, 100.0, 300.0};
  const std::vector<double> factors{0.25, 1.0, 4.0};
  RadarFilter radar;
  radar.variance = {1e6, 3e3};
  std::vector<RadarFilter> hypotheses;
  for (const double velocity : velocities)
    for (const double factor : believed_factors) {
      hypotheses.push_back(radar);
      hypotheses.back().x0 = {0.0, velocity};
      hypotheses.back().sigma_m *= std::sqrt(factor);
    }
  const auto bank = radar_bank(hypotheses);
  std::vector<double> nees;
  for (std::size_t run = 0; run < runs; ++run) {
    RandomStream random({.seed = 3, .role = Role::evaluation, .run = run}, StreamId::test);
    const double sigma = radar.sigma_m * std::sqrt(factors[random.index(3)]);
    Eigen::Vector2d x(1e3 * random.normal(), velocities[random.index(4)] + std::sqrt(3e3) * random.normal());
    StepRecord record;
    bank->reset();
    for (int k = 1; k <= 25; ++k) {
      x[0] += x[1];
      x += Eigen::Vector2d(std::sqrt(5.0) * random.normal(), std::sqrt(0.1) * random.normal());
      record = bank->step(position(k, x[0] + sigma * random.normal()))[0];
    }
    nees.push_back(mahalanobis_squared(record.P, BoundedVector(record.x - x)));
  }
  return testing::moments(nees);
}

TEST(FilterBank, IsConsistentOnItsOwnFamily) {
  constexpr std::size_t kRuns = 1500;
  const testing::Moments nees = bank_nees({0.25, 1.0, 4.0}, kRuns);
  EXPECT_NEAR(nees.mean, 2.0, testing::mean_margin(std::sqrt(nees.variance), kRuns));
}

TEST(FilterBank, ThatDoesNotHaveTheNoiseOfTheFamilyIsCaught) {
  constexpr std::size_t kRuns = 500;
  const testing::Moments nees = bank_nees({0.05}, kRuns);
  EXPECT_GT(nees.mean, 2.0 + testing::mean_margin(std::sqrt(nees.variance), kRuns));
}

TEST(FilterBank, MissingMeasurementLeavesNoTrace) {
  RadarFilter fast;
  fast.x0 = {0.0, 300.0};
  const auto bank = radar_bank({RadarFilter{}, fast});
  const auto clean = bank->fresh();
  int missing = 0;
  for (const Measurement& measurement : radar_log(9, 60)) {
    if (static_cast<int>(measurement.time_s) % 3 == 0) {
      const auto records = bank->step(position(measurement.time_s - 0.3, kInfinity));
      EXPECT_EQ(records[0].status, StepStatus::coasted);
      ++missing;
    }
    const auto with = bank->step(measurement);
    const auto without = clean->step(measurement);
    ASSERT_EQ(with[0].x, without[0].x);
    ASSERT_EQ(with[0].P, without[0].P);
  }
  EXPECT_EQ(bank->counts().missing, missing);
}

TEST(FilterBank, RepeatedAndLateMeasurementsAreNotUsed) {
  const auto bank = radar_bank({RadarFilter{}});
  EXPECT_TRUE(bank->step(position(kNaN, 5.0)).empty());
  const BoundedVector x = bank->step(position(1.0, 5000.0))[0].x;
  for (const Measurement& again : {position(1.0, 5000.0), position(0.5, 1.0)}) {
    const auto records = bank->step(again);
    ASSERT_EQ(records.size(), 1u);
    EXPECT_EQ(records[0].status, StepStatus::rejected);
    EXPECT_EQ(records[0].x, x);
  }
  EXPECT_EQ(bank->counts().repeated, 1);
  EXPECT_EQ(bank->counts().out_of_order, 2);
}

TEST(FilterBank, HostileMeasurementsLeaveAValidMixture) {
  RadarFilter fast;
  fast.x0 = {0.0, 300.0};
  const auto bank = radar_bank({RadarFilter{}, fast});
  double time_s = 1.0;
  for (const double z : {100.0, 1e160, 1e308, -1e308, kNaN, 5e3, 1e4}) {
    for (const double sigma : {3000.0, kNaN, 1e300}) {
      Measurement measurement = position(time_s += 1.0, z);
      measurement.sigma = BoundedVector::Constant(1, sigma);
      const auto records = bank->step(measurement);
      ASSERT_EQ(records.size(), 1u);
      EXPECT_TRUE(records[0].x.allFinite()) << z << " " << sigma;
      EXPECT_TRUE(is_covariance(records[0].P)) << z << " " << sigma << "\n" << records[0].P;
    }
  }
}

}  // namespace
}  // namespace truebearing::filter_bank_test
