// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tracker/range_hypotheses.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "tests/support/bearing_trackers.hpp"
#include "truebearing/core/covariance.hpp"

namespace truebearing::range_hypotheses_test {
namespace {

constexpr double kAlgebra = 1e-9;

const SensorState kSensor{{300.0, -200.0}, {3.0, 4.0}};
constexpr double kBearing = 0.8, kSigma = 0.02;
constexpr TargetGuess kGuess{.range_m = 6000.0, .range_sigma_m = 3000.0};

RangePrior prior_between(double low_m, double high_m) {
  RangePrior prior = testing::guessed_range();
  prior.between = RangePrior::Interval{low_m, high_m};
  return prior;
}

GaussianState mixture(const RangeHypotheses& hypotheses, const TargetGuess& guess) {
  GaussianState mixed{Eigen::Vector4d::Zero(), Eigen::Matrix4d::Zero()};
  std::vector<RangeHypotheses::Weighted> all;
  double total = 0.0;
  for (int i = 0; i < hypotheses.size(); ++i) {
    all.push_back(hypotheses.at(i, kBearing, kSigma, kSensor, guess));
    total += std::exp(all.back().log_weight);
  }
  for (const auto& [state, log_weight] : all) mixed.x += std::exp(log_weight) / total * state.x;
  for (const auto& [state, log_weight] : all) {
    const Eigen::Vector4d d = state.x - mixed.x;
    mixed.P += std::exp(log_weight) / total * (state.P + d * d.transpose());
  }
  return mixed;
}

// However finely it is cut, the whole is the prior.
TEST(RangeHypotheses, TogetherHaveTheMeanAndCovarianceOfThePrior) {
  const RangePrior prior = prior_between(3e3, 15e3);
  const GaussianState whole = prior.state(kBearing, kSigma, kSensor, kGuess);
  for (const int ranges : {1, 2, 6, 24})
    for (const int cells : {1, 3, 8}) {
      const GaussianState mixed = mixture({prior, ranges, cells}, kGuess);
      EXPECT_LT((mixed.x - whole.x).norm(), kAlgebra * whole.x.norm()) << ranges << " " << cells;
      EXPECT_LT((mixed.P - whole.P).norm(), kAlgebra * whole.P.norm()) << ranges << " " << cells;
    }
}

// Speeds between 2 and 8 m/s on any course: E v = 0, E v v' = 14 I.
TEST(RangeHypotheses, OfAnIntervalOfSpeedsHaveItsMoments) {
  RangeHypotheses hypotheses{prior_between(3e3, 15e3), 4, 8};
  hypotheses.speed_between_mps = {2.0, 8.0};
  const GaussianState mixed = mixture(hypotheses, kGuess);
  EXPECT_LT(mixed.x.tail<2>().norm(), kAlgebra);
  EXPECT_LT((mixed.P.bottomRightCorner<2, 2>() - 14.0 * Eigen::Matrix2d::Identity()).norm(), kAlgebra);
  for (int i = 0; i < hypotheses.size(); ++i) {
    const GaussianState cell = hypotheses.at(i, kBearing, kSigma, kSensor, kGuess).state;
    EXPECT_TRUE(is_covariance(cell.P));
    EXPECT_NEAR(cell.x.tail<2>().norm(), 5.0, 0.2);
  }
}

TEST(RangeHypotheses, LieInGeometricProgressionWithinTheInterval) {
  const RangeHypotheses hypotheses{prior_between(1e3, 16e3), 4};
  double last_m = 1e3;
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector2d offset =
        hypotheses.at(i, kBearing, kSigma, kSensor, kGuess).state.x.head<2>() - kSensor.position_m;
    EXPECT_GT(offset.norm(), last_m);
    EXPECT_LT(offset.norm(), 2.0 * last_m);
    EXPECT_NEAR(std::atan2(offset.x(), offset.y()), kBearing, kAlgebra);
    last_m *= 2.0;
  }
}

TEST(RangeHypotheses, WithoutAnIntervalStayWithinReasonOfTheGuess) {
  const auto nearest_m = [](const RangeHypotheses& hypotheses, const TargetGuess& guess) {
    return (hypotheses.at(0, kBearing, kSigma, kSensor, guess).state.x.head<2>() - kSensor.position_m).norm();
  };
  RangeHypotheses hypotheses{testing::guessed_range(), 40};
  EXPECT_NEAR(nearest_m(hypotheses, {.range_m = 6000.0, .range_sigma_m = 1000.0}), 3500.0, 100.0);
  EXPECT_NEAR(nearest_m(hypotheses, {.range_m = 6000.0, .range_sigma_m = 5000.0}), 300.0, 30.0) << "5 %";
  hypotheses.least_range_m = 600.0;
  EXPECT_NEAR(nearest_m(hypotheses, {.range_m = 6000.0, .range_sigma_m = 5000.0}), 600.0, 60.0);
}

TEST(RangeHypotheses, GuessFarOutsideLeavesTheNearestRange) {
  const RangeHypotheses hypotheses{prior_between(3e3, 15e3), 6};
  for (const double range_m : {-9e5, 9e5}) {
    const TargetGuess guess{.range_m = range_m, .range_sigma_m = 1000.0};
    for (int i = 0; i < 6; ++i) {
      const auto weighted = hypotheses.at(i, kBearing, kSigma, kSensor, guess);
      EXPECT_EQ(weighted.log_weight == 0.0, i == (range_m < 0.0 ? 0 : 5));
      EXPECT_TRUE(is_covariance(weighted.state.P));
    }
  }
}

TEST(RangeBank, OfOneHypothesisIsThatFilter) {
  const auto bank = testing::range_bank({testing::guessed_range(), 1});
  const auto whole = testing::range_bank({prior_between(1.0, 1e6), 1});
  const auto tracker = testing::bearing_tracker<KalmanFilter<4>>();
  for (const Measurement& measurement : testing::bearings_run(3).measurements) {
    EXPECT_EQ(bank->step(measurement).size(), 1u);
    const StepRecord record = whole->step(measurement)[0], expected = tracker->step(measurement)[0];
    // A guess of 5 to 10 km +- 2 km is hardly cut off at 1 m.
    ASSERT_LT((record.x - expected.x).norm(), 0.02 * std::sqrt(expected.P.trace()));
  }
}

TEST(RangeBank, WaitsForTheFirstBearingAndItsGuess) {
  const auto bank = testing::range_bank({testing::guessed_range(), 5});
  std::vector<Measurement> log = testing::bearings_run(4).measurements;
  Measurement silent = log[0];
  silent.guess.reset();
  EXPECT_TRUE(bank->step(silent).empty());
  log[1].guess = log[0].guess;
  EXPECT_EQ(bank->step(log[1]).size(), 1u);
}

}  // namespace
}  // namespace truebearing::range_hypotheses_test
