// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tma/target_motion_batch.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "tests/support/allocation_count.hpp"
#include "tests/support/bearing_frequency_runs.hpp"
#include "tests/support/bearing_runs.hpp"
#include "tests/support/statistics.hpp"
#include "truebearing/core/covariance.hpp"
#include "truebearing/measurement/fisher_information.hpp"
#include "truebearing/tma/frequency_changes.hpp"

namespace truebearing::target_motion_batch_test {
namespace {

using testing::data_scenario;
using testing::truth_at;
using testing::two_legs;
using testing::window_of;

const Eigen::Vector4d kTarget(3000.0, 5000.0, -2.0, 1.0);

Eigen::Vector4d at_end(double t) {
  Eigen::Vector4d x = kTarget;
  x.head<2>() += t * kTarget.tail<2>();
  return x;
}

TEST(TargetMotionBatch, FindsTheTargetOfExactBearings) {
  TargetMotionBatch batch;
  const BatchEstimate estimate = batch.solve(two_legs(kTarget, 300.0, 600.0));
  ASSERT_TRUE(estimate.found);
  EXPECT_LT((estimate.x - at_end(600.0)).norm(), 1e-3);
  EXPECT_LT(estimate.cost, 1e-9);
  EXPECT_TRUE(batch.observability().observable());
  EXPECT_EQ(estimate.non_finite_starts, 0);
}

TEST(TargetMotionBatch, CovarianceIsTheBoundAtTheEstimate) {
  const BearingWindow window = two_legs(kTarget, 300.0, 600.0);
  TargetMotionBatch batch;
  const BatchEstimate estimate = batch.solve(window);
  const Eigen::Matrix4d information = window.cartesian(estimate.x, estimate.time_s).A;
  EXPECT_LT((estimate.P * information - Eigen::Matrix4d::Identity()).norm(), 1e-3);
}

TEST(TargetMotionBatch, TurnsAndShiftsWithTheFrame) {
  const BearingWindow window = two_legs(kTarget, 300.0, 900.0, 1.0);
  TargetMotionBatch batch;
  const BatchEstimate plain = batch.solve(window);
  for (const double angle : {0.3, 2.0, -1.7, 3.1}) {
    const Eigen::Rotation2Dd rotation(-angle);  // clockwise
    const Eigen::Vector2d shift(12345.0, -6789.0);
    BearingWindow moved;
    for (std::size_t i = 0; i < window.size(); ++i)
      moved.add(window.time_s(i) + 1000.0, window.bearing_rad(i) + angle, radians(1.0),
                rotation * window.site_m(i) + shift);
    const BatchEstimate turned = batch.solve(moved);
    Eigen::Matrix4d R = Eigen::Matrix4d::Zero();
    R.topLeftCorner<2, 2>() = R.bottomRightCorner<2, 2>() = rotation.toRotationMatrix();
    Eigen::Vector4d expected = R * plain.x;
    expected.head<2>() += shift;
    EXPECT_LT((turned.x - expected).norm(), 1e-3) << angle;
    EXPECT_NEAR(turned.cost, plain.cost, 1e-8);
    EXPECT_LT((turned.P - R * plain.P * R.transpose()).norm(), 1e-5 * plain.P.norm());
  }
}

TEST(TargetMotionBatch, ScalesWithOwnShipsWay) {
  const BearingWindow window = two_legs(kTarget, 300.0, 900.0, 1.0);
  TargetMotionBatch batch;
  const BatchEstimate plain = batch.solve(window);
  EXPECT_TRUE(plain.converged);
  for (const double scale : {1e-3, 0.1, 10.0, 1e3}) {
    BearingWindow scaled;
    for (std::size_t i = 0; i < window.size(); ++i)
      scaled.add(window.time_s(i), window.bearing_rad(i), radians(1.0), scale * window.site_m(i));
    const BatchEstimate estimate = batch.solve(scaled);
    EXPECT_LT((estimate.x - scale * plain.x).norm(), 1e-3 * scale * plain.x.norm()) << scale;
    EXPECT_LT((estimate.P - scale * scale * plain.P).norm(), 1e-2 * scale * scale * plain.P.norm()) << scale;
    EXPECT_TRUE(batch.observability().observable()) << scale;
  }
}

TEST(TargetMotionBatch, SaysWhereItsLimitEndedIt) {
  const BearingWindow window = two_legs(kTarget, 300.0, 900.0, 1.0);
  EXPECT_FALSE(TargetMotionBatch({.max_iterations = 2}).solve(window).converged);
}

TEST(TargetMotionBatch, WholeTurnsChangeNothing) {
  const BearingWindow window = two_legs(kTarget, 300.0, 900.0, 1.0);
  BearingWindow turned;
  for (std::size_t i = 0; i < window.size(); ++i)
    turned.add(window.time_s(i), window.bearing_rad(i) + 2.0 * kPi * static_cast<double>(i % 3), radians(1.0),
               window.site_m(i));
  TargetMotionBatch batch;
  EXPECT_LT((batch.solve(window).x - batch.solve(turned).x).norm(), 1e-3);
}

// A filter that believes in a tenth of the noise is far outside the interval, an honest one inside.
TEST(TargetMotionBatch, IsConsistentAndEfficientWhereTheRangeIsObservable) {
  constexpr int kRuns = 200;
  const auto scenario = data_scenario("cho_s1");
  TargetMotionBatch batch;
  double nees = 0.0, boastful = 0.0;
  for (int run = 0; run < kRuns; ++run) {
    const Recording recording = scenario->simulate({5, Role::evaluation, static_cast<std::uint64_t>(run)});
    const BatchEstimate estimate = batch.solve(window_of(recording, 1800.0));
    const Eigen::Vector4d error = truth_at(recording, 1800.0) - estimate.x;
    nees += mahalanobis_squared(estimate.P, error);
    boastful += mahalanobis_squared(Eigen::Matrix4d(0.1 * estimate.P), error);
  }
  EXPECT_FALSE(testing::is_too_small(nees, 4.0 * kRuns)) << nees / kRuns;
  EXPECT_FALSE(testing::is_too_large(nees, 4.0 * kRuns)) << nees / kRuns;
  EXPECT_TRUE(testing::is_too_large(boastful, 4.0 * kRuns)) << boastful / kRuns;
}

TEST(TargetMotionBatch, ThreeStartsFindWhatTwoHundredAndTwentyFiveFind) {
  const auto scenario = data_scenario("bearings_only_observable");
  TargetMotionBatch few;
  TargetMotionBatch many({.start_grid = true});
  for (std::uint64_t run = 0; run < 50; ++run) {
    const BearingWindow window = window_of(scenario->simulate({3, Role::evaluation, run}));
    EXPECT_LE(few.solve(window).cost, many.solve(window).cost + 1e-6) << run;
  }
}

TEST(TargetMotionBatch, PriorKeepsAnUnobservableRange) {
  const BearingWindow window = two_legs(kTarget, 1e9, 600.0, 1.0);
  BatchPrior prior;
  prior.velocity_information = Eigen::Matrix2d::Identity() / 25.0;
  prior.range = BatchPrior::Range{5800.0, 500.0, {0.0, 0.0}, 0.0};
  TargetMotionBatch batch;
  const BatchEstimate estimate = batch.solve(window, prior);
  ASSERT_TRUE(estimate.found);
  EXPECT_NEAR((estimate.x - 600.0 * Eigen::Vector4d(estimate.x[2], estimate.x[3], 0, 0)).head<2>().norm(), 5800.0,
              500.0);
  EXPECT_FALSE(batch.observability().observable());
  EXPECT_TRUE(is_covariance(estimate.P));
}

TEST(TargetMotionBatch, HuberLossShrugsOffOutliers) {
  const BearingWindow clean = two_legs(kTarget, 300.0, 900.0, 1.0);
  BearingWindow spoilt;
  for (std::size_t i = 0; i < clean.size(); ++i)
    spoilt.add(clean.time_s(i), clean.bearing_rad(i) + (i % 9 == 4 ? radians(25.0) : 0.0), radians(1.0),
               clean.site_m(i));
  const auto error = [&](TargetMotionBatch batch) { return (batch.solve(spoilt).x - at_end(900.0)).head<2>().norm(); };
  const double plain = error(TargetMotionBatch()), robust = error(TargetMotionBatch({.huber_sigmas = 1.5}));
  EXPECT_LT(robust, 0.5 * plain);
}

TEST(TargetMotionBatch, ToldOfAnotherMinimumThatIsNearlyAsGood) {
  TargetMotionBatch batch;
  batch.solve(two_legs(kTarget, 300.0, 900.0, 1.0));
  EXPECT_TRUE(batch.ambiguities().empty());
  const BatchEstimate best = batch.solve(two_legs(kTarget, 1e9, 900.0, 1.0));  // any range will do
  ASSERT_FALSE(batch.ambiguities().empty());
  for (const Ambiguity& other : batch.ambiguities()) {
    EXPECT_GE(other.cost, 0.0);
    EXPECT_LT(other.cost, 1.92);
    EXPECT_GT((other.x - best.x).head<2>().norm(), 100.0);
  }
}

TEST(TargetMotionBatch, FindsTheTargetOfExactBearingsAndFrequencies) {
  const auto [bearings, frequencies] = testing::KimSong::windows(0, testing::jump(0.0), 0.0);
  TargetMotionBatch batch;
  const BatchEstimate estimate = batch.solve(bearings, std::nullopt, nullptr, &frequencies);
  ASSERT_TRUE(estimate.found);
  EXPECT_LT((estimate.x - testing::KimSong::target(1050.0)).norm(), 1e-2);
  EXPECT_LT(estimate.cost, 1e-9);
  EXPECT_TRUE(batch.observability().observable());
}

TEST(TargetMotionBatch, WithFrequenciesItTurnsAndShiftsWithTheFrame) {
  const auto [bearings, frequencies] = testing::KimSong::windows(0);
  TargetMotionBatch batch;
  const BatchEstimate plain = batch.solve(bearings, std::nullopt, nullptr, &frequencies);
  for (const double angle : {0.3, 2.0, -1.7, 3.1}) {
    const Eigen::Matrix2d R = Eigen::Rotation2Dd(-angle).toRotationMatrix();  // clockwise
    const Eigen::Vector2d shift(12345.0, -6789.0);
    BearingWindow moved;
    DopplerWindow heard;
    for (std::size_t i = 0; i < bearings.size(); ++i) {
      const SensorState& own = frequencies.sensor(i);
      // Whole turns change nothing either.
      moved.add(bearings.time_s(i) + 1000.0, bearings.bearing_rad(i) + angle + 2.0 * kPi * static_cast<double>(i % 3),
                radians(1.0), R * own.position_m + shift);
      heard.add(bearings.time_s(i) + 1000.0, frequencies.frequency_hz(i), frequencies.sigma_hz(i),
                {R * own.position_m + shift, R * own.velocity_mps});
    }
    const BatchEstimate turned = batch.solve(moved, std::nullopt, nullptr, &heard);
    Eigen::Vector4d expected;
    expected << R * plain.x.head<2>() + shift, R * plain.x.tail<2>();
    EXPECT_LT((turned.x - expected).norm(), 1e-2) << angle;
    EXPECT_NEAR(turned.cost, plain.cost, 1e-7);
  }
}

TEST(TargetMotionBatch, FrequenciesMayBeFewerThanBearingsOrBetweenThem) {
  const auto [bearings, frequencies] = testing::KimSong::windows(0);
  BearingWindow odd;
  DopplerWindow even;
  for (std::size_t i = 0; i < bearings.size(); ++i) {
    if (i % 2 == 1)
      odd.add(bearings.time_s(i), bearings.bearing_rad(i), radians(1.0), bearings.site_m(i));
    else
      even.add(frequencies.time_s(i), frequencies.frequency_hz(i), 0.02, frequencies.sensor(i));
  }
  TargetMotionBatch batch;
  const BatchEstimate estimate = batch.solve(odd, std::nullopt, nullptr, &even);
  ASSERT_TRUE(estimate.found);
  EXPECT_LT((estimate.x - testing::KimSong::target(odd.last_time_s())).head<2>().norm(), 4.5 * std::sqrt(2.0) * 155.0);
  const DopplerWindow none;
  EXPECT_EQ(batch.solve(bearings, std::nullopt, nullptr, &none).x, batch.solve(bearings).x);
}

TEST(TargetMotionBatch, RefiningFromAnEstimateLeavesItWhereItIs) {
  const auto [bearings, frequencies] = testing::KimSong::windows(1);
  TargetMotionBatch batch;
  const BatchEstimate estimate = batch.solve(bearings, std::nullopt, nullptr, &frequencies);
  const BatchEstimate refined = batch.refine(estimate.x, bearings, std::nullopt, &frequencies);
  EXPECT_LT((refined.x - estimate.x).norm(), 0.1);
  EXPECT_NEAR(refined.objective, estimate.objective, 1e-6);
}

TEST(TargetMotionBatch, TooFewBearingsAreNoEstimate) {
  TargetMotionBatch batch;
  BearingWindow window;
  EXPECT_FALSE(batch.solve(window).found);
  for (int k = 0; k < 5; ++k) window.add(10.0, 0.3, 0.02, {0.0, 0.0});  // all at one time
  EXPECT_FALSE(batch.solve(window).found);
}

TEST(TargetMotionBatch, OneBearingAgainAndAgainFromAShipAtRestIsFiniteAndNothing) {
  BearingWindow window;
  for (int k = 0; k < 20; ++k) window.add(10.0 * k, 0.7, radians(1.0), {100.0, 200.0});
  TargetMotionBatch batch;
  const BatchEstimate estimate = batch.solve(window);
  ASSERT_TRUE(estimate.found);
  EXPECT_TRUE(estimate.x.allFinite());
  EXPECT_TRUE(is_covariance(estimate.P));
  EXPECT_FALSE(batch.observability().observable());
}

TEST(TargetMotionBatch, SecondSolutionAllocatesNothing) {
  const BearingWindow window = two_legs(kTarget, 300.0, 900.0, 1.0);
  TargetMotionBatch batch;
  batch.solve(window);
  EXPECT_EQ(testing::allocations_of([&] { batch.solve(window); }), 0);
}

TEST(TargetMotionBatch, SecondSolutionOfASourceThatChangedAllocatesNothing) {
  testing::BearingFrequencyWindows windows = testing::KimSong::windows(4, testing::jump(30.0, 600.0, 800.0));
  TargetMotionBatch batch;
  FrequencyChangeBatch changes;
  changes.solve(batch, windows.bearings, windows.frequencies);
  EXPECT_EQ(testing::allocations_of([&] { changes.solve(batch, windows.bearings, windows.frequencies); }), 0);
}

}  // namespace
}  // namespace truebearing::target_motion_batch_test
