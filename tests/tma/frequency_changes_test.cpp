// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tma/frequency_changes.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <utility>
#include <vector>

#include "tests/support/bearing_frequency_runs.hpp"
#include "tests/support/statistics.hpp"
#include "tests/support/tma_rates.hpp"
#include "truebearing/core/covariance.hpp"

namespace truebearing::frequency_changes_test {
namespace {

using Handling = FrequencyChangeOptions::Handling;
using testing::BearingFrequencyWindows;
using testing::jump;
using testing::KimSong;

FrequencyChangeOptions handling(Handling h) {
  FrequencyChangeOptions options;
  options.handling = h;
  return options;
}

struct Solved {
  BatchEstimate estimate;
  std::vector<FrequencyChange> changes;
  bool used_frequencies;
  double error_m;
};

Solved solve(BearingFrequencyWindows& windows, Handling h = Handling::levels) {
  TargetMotionBatch batch;
  FrequencyChangeBatch changes(handling(h));
  Solved solved;
  solved.estimate = changes.solve(batch, windows.bearings, windows.frequencies);
  solved.changes.assign(changes.changes().begin(), changes.changes().end());
  solved.used_frequencies = changes.used_frequencies();
  solved.error_m = (solved.estimate.x - KimSong::target(1050.0)).head<2>().norm();
  return solved;
}

std::vector<int> levels_of(const DopplerWindow& window) {
  std::vector<int> levels;
  for (std::size_t i = 0; i < window.size(); ++i) levels.push_back(window.level(i));
  return levels;
}
std::vector<int> true_levels(const DopplerWindow& window) {
  std::vector<int> levels;
  for (std::size_t i = 0; i < window.size(); ++i)
    levels.push_back(window.time_s(i) >= 600.0 && window.time_s(i) < 800.0);
  return levels;
}

TEST(FrequencyEdges, PapersThresholdIsThatOfItsFalseAlarmProbability) {
  EXPECT_NEAR(normal_quantile(1.0 - 0.5 * FrequencyChangeOptions{}.false_alarm_probability), 4.81123, 1e-4);
}

TEST(FrequencyEdges, AreBetweenNeighboursThatDifferByMoreThanTheirNoise) {
  DopplerWindow window;
  const double step = 4.81123 * std::sqrt(2.0) * 0.02;
  const std::vector<double> offsets{0.0, 0.99 * step, 0.99 * step, -0.02 * step, 2.0, 2.0};
  for (std::size_t i = 0; i < offsets.size(); ++i) window.add(static_cast<double>(i), 100.0 + offsets[i], 0.02, {});
  std::vector<int> segment;
  number_segments(window, 4.81123, segment);
  EXPECT_EQ(segment, (std::vector<int>{0, 0, 0, 1, 2, 2}));
}

TEST(FrequencyEdges, AlarmAsOftenAsTheyAreMeantTo) {
  constexpr int kCount = 1000000;
  constexpr double kProbability = 1e-3;
  RandomStream stream({1, Role::evaluation, 0}, StreamId::test);
  DopplerWindow window;
  for (int i = 0; i < kCount; ++i) window.add(i, 100.0 + 0.02 * stream.normal(), 0.02, {});
  std::vector<int> segment;
  number_segments(window, normal_quantile(1.0 - 0.5 * kProbability), segment);
  // Neighbouring differences share a frequency, which about doubles the variance at most.
  EXPECT_NEAR(segment.back(), kCount * kProbability, 4.4 * std::sqrt(2.0 * kCount * kProbability));
}

// At the paper's own threshold: what it finds of jumps of so many Hz, there and back from each frequency to the next.
TEST(FrequencyEdges, FindJumpsAsOftenAsTheirSizeSays) {
  constexpr int kCount = 200000;
  const double gamma = normal_quantile(1.0 - 0.5 * FrequencyChangeOptions{}.false_alarm_probability);
  const auto beyond = [](double x) { return 0.5 * std::erfc(x / std::sqrt(2.0)); };
  const std::vector<std::pair<double, double>> expected_at{{0.05, 0.0011}, {0.10, 0.101}, {0.14, 0.556}, {0.20, 0.988}};
  for (const auto& [jump_hz, prototype] : expected_at) {
    RandomStream stream({2, Role::evaluation, 0}, StreamId::test);
    DopplerWindow window;
    for (int i = 0; i <= kCount; ++i) window.add(i, 100.0 + i % 2 * jump_hz + 0.02 * stream.normal(), 0.02, {});
    std::vector<int> segment;
    number_segments(window, gamma, segment);
    const double sigmas = jump_hz / (0.02 * std::sqrt(2.0));
    const double expected = beyond(gamma - sigmas) + beyond(gamma + sigmas);
    EXPECT_NEAR(segment.back(), kCount * expected, 5.0 * std::sqrt(2.0 * kCount * expected * (1.0 - expected)));
    EXPECT_NEAR(expected, prototype, 0.01 * prototype + 1e-4) << jump_hz;
  }
}

TEST(FrequencyEdges, AlarmAtThePapersThresholdOnceInSixHundredThousand) {
  constexpr int kWindows = 80, kCount = 50000;  // 4e6 pairs: 6 alarms are expected, which come in twos
  int alarms = 0;
  RandomStream stream({3, Role::evaluation, 0}, StreamId::test);
  for (int k = 0; k < kWindows; ++k) {
    DopplerWindow window;
    for (int i = 0; i <= kCount; ++i) window.add(i, 100.0 + 0.02 * stream.normal(), 0.02, {});
    std::vector<int> segment;
    number_segments(window, 4.81123, segment);
    alarms += segment.back();
  }
  EXPECT_GT(alarms, 0);
  EXPECT_LT(alarms, 18);
}

TEST(FrequencyChanges, LevelsOfAnotherToneAndBackAreThoseThatWere) {
  for (std::uint64_t run = 0; run < 20; ++run) {
    BearingFrequencyWindows windows = KimSong::windows(run, jump(30.0, 600.0, 800.0)), known = windows;
    const Solved solved = solve(windows);
    EXPECT_EQ(levels_of(windows.frequencies), true_levels(windows.frequencies)) << run;
    known.frequencies.set_levels(true_levels(known.frequencies));
    TargetMotionBatch batch;
    const BatchEstimate expected = batch.solve(known.bearings, std::nullopt, nullptr, &known.frequencies);
    EXPECT_LT((solved.estimate.x - expected.x).norm(), 1e-2) << run;
    EXPECT_NEAR(solved.estimate.cost, expected.cost, 1e-6) << run;
    ASSERT_EQ(solved.changes.size(), 2u);
    EXPECT_EQ(solved.changes[0].time_s, 602.0);
    EXPECT_EQ(solved.changes[1].time_s, 805.0);
    EXPECT_NEAR(solved.changes[0].frequency_hz, 130.0, 0.1);
    EXPECT_NEAR(solved.changes[1].frequency_hz, 100.0, 0.1);
  }
}

TEST(FrequencyChanges, AConstantToneIsOneLevel) {
  int alarms = 0;
  for (std::uint64_t run = 0; run < 300; ++run) {
    BearingFrequencyWindows windows = KimSong::windows(run);
    alarms += !solve(windows).changes.empty();
  }
  EXPECT_LE(alarms, 3);  // at one in 500, four or more come once in 300
}

TEST(FrequencyChanges, AJumpTooSmallForEdgesIsFoundByTheScan) {
  int found = 0;
  double squares = 0.0, ignored_squares = 0.0;
  constexpr int kRuns = 50;
  for (std::uint64_t run = 0; run < kRuns; ++run) {
    BearingFrequencyWindows windows = KimSong::windows(run, jump(0.04, 600.0, 800.0)), ignored = windows;
    std::vector<int> segment;
    number_segments(windows.frequencies, 4.81123, segment);
    const Solved solved = solve(windows);
    found += segment.back() == 0 && windows.frequencies.levels() == 2 && !solved.changes.empty();
    squares += solved.error_m * solved.error_m;
    const double averaged_m = solve(ignored, Handling::ignored).error_m;
    ignored_squares += averaged_m * averaged_m;
  }
  // Errors of the bound's 155 m lie mostly along one line: a chi-square of one degree of freedom a run, or of more.
  constexpr double kBound_m2 = 155.0 * 155.0;
  EXPECT_GE(found, 47) << "of 50";
  EXPECT_FALSE(testing::is_too_large(squares / kBound_m2, kRuns)) << std::sqrt(squares / kRuns);
  EXPECT_TRUE(testing::is_too_large(ignored_squares / kBound_m2, kRuns)) << std::sqrt(ignored_squares / kRuns);
}

TEST(FrequencyChanges, ScansStatisticIsThatOfTheProjectedIndicator) {
  BearingFrequencyWindows windows = KimSong::windows(5, jump(0.05, 600.0, 800.0));
  TargetMotionBatch batch;
  const DopplerWindow& window = windows.frequencies;
  const BatchEstimate estimate = batch.solve(windows.bearings, std::nullopt, nullptr, &window);
  FrequencyChangeBatch changes;
  const IntervalScore best = changes.scan(window, estimate);

  // All residuals and all parameters at once, each interval by itself.
  const Eigen::Index m = static_cast<Eigen::Index>(windows.bearings.size()),
                     n = static_cast<Eigen::Index>(window.size());
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(m + n, 5);
  Eigen::VectorXd r(m + n), shift(n);
  const double f0 = window.source(0, estimate.x, estimate.time_s).frequency_hz;
  for (Eigen::Index i = 0; i < m; ++i) {
    const std::size_t k = static_cast<std::size_t>(i);
    J.row(i).head<4>() = windows.bearings.jacobian(k, estimate.x, estimate.time_s) / KimSong::kSigma_rad;
    r[i] = windows.bearings.residual(k, estimate.x, estimate.time_s) / KimSong::kSigma_rad;
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    const std::size_t k = static_cast<std::size_t>(i);
    const DopplerWindow::Shift g = window.shift(k, estimate.x, estimate.time_s);
    shift[i] = g.value / KimSong::kSigma_hz;
    J.row(m + i) << f0 * g.per_state / KimSong::kSigma_hz, shift[i];
    r[m + i] = (window.frequency_hz(k) - f0 * g.value) / KimSong::kSigma_hz;
  }
  const Eigen::VectorXd scale = J.colwise().norm().cwiseInverse();
  const Eigen::MatrixXd scaled = J * scale.asDiagonal();
  const Eigen::LDLT<Eigen::MatrixXd> normal(scaled.transpose() * scaled);
  double largest = 0.0;
  for (Eigen::Index a = 1; a < n; ++a)
    for (Eigen::Index b = a + 1; b <= n; ++b) {
      Eigen::VectorXd h = Eigen::VectorXd::Zero(m + n);
      h.segment(m + a, b - a) = shift.segment(a, b - a);
      const Eigen::VectorXd coupling = scaled.transpose() * h;
      const double V = h.squaredNorm() - coupling.dot(normal.solve(coupling)), s = h.dot(r);
      if (V > 1e-6 * h.squaredNorm()) largest = std::max(largest, s * s / V);
    }
  EXPECT_NEAR(best.statistic, largest, 1e-3 * largest);
  EXPECT_NEAR(window.time_s(best.begin), 602.0, 50.0);
  EXPECT_NEAR(window.time_s(best.end), 805.0, 50.0);
}

TEST(FrequencyChanges, SwitchUsesBearingsOnlyAfterAnEdgeAndAllBeforeOne) {
  BearingFrequencyWindows windows = KimSong::windows(2, jump(30.0, 600.0, 800.0));
  const Solved switched = solve(windows, Handling::bearings_only);
  TargetMotionBatch batch;
  EXPECT_EQ(switched.estimate.x, batch.solve(windows.bearings).x);
  EXPECT_FALSE(switched.used_frequencies);
  EXPECT_EQ(switched.changes.size(), 2u);

  BearingFrequencyWindows constant = KimSong::windows(2);
  const Solved used = solve(constant, Handling::bearings_only);
  EXPECT_TRUE(used.used_frequencies);
  EXPECT_EQ(used.estimate.x, batch.solve(constant.bearings, std::nullopt, nullptr, &constant.frequencies).x);
}

TEST(FrequencyChanges, OneOutlierIsALevelOfItsOwnAndNoChange) {
  BearingFrequencyWindows windows = KimSong::windows(1, jump(0.0)), spoilt;
  spoilt.bearings = windows.bearings;
  for (std::size_t i = 0; i < windows.frequencies.size(); ++i)
    spoilt.frequencies.add(windows.frequencies.time_s(i), windows.frequencies.frequency_hz(i) + (i == 77 ? 5.0 : 0.0),
                           KimSong::kSigma_hz, windows.frequencies.sensor(i));
  const Solved plain = solve(windows), robust = solve(spoilt);
  EXPECT_EQ(spoilt.frequencies.levels(), 2);
  EXPECT_TRUE(robust.changes.empty());
  EXPECT_LT((robust.estimate.x - plain.estimate.x).head<2>().norm(), 50.0);
}

// A few in a row cut the level, others hide in the first piece of it: without them it is as the rest.
TEST(FrequencyChanges, ManyOutliersAreNoChangeOfTheTone) {
  const auto scenario = testing::scenario_with_turns("passive_sonar_a", "");
  const testing::TmaCase what{.outlier_share = 0.05};
  for (const std::uint64_t run : {105u, 209u, 655u}) {
    testing::TmaRates rates;
    testing::TmaLog(scenario->simulate({5, Role::evaluation, run}), what, run).examine(what, rates);
    EXPECT_EQ(rates.jumps, 0) << run;
  }
}

TEST(FrequencyChanges, FrequenciesThatAreAllOutliersLeaveTheBearings) {
  BearingFrequencyWindows windows;
  windows.bearings = KimSong::windows(1).bearings;
  RandomStream stream({9, Role::evaluation, 0}, StreamId::test);
  for (std::size_t i = 0; i < windows.bearings.size(); ++i)
    windows.frequencies.add(windows.bearings.time_s(i), stream.uniform(10.0, 1000.0), KimSong::kSigma_hz,
                            KimSong::own_ship(windows.bearings.time_s(i)));
  for (const Handling h : {Handling::levels, Handling::segments, Handling::bearings_only, Handling::ignored}) {
    const Solved solved = solve(windows, h);
    ASSERT_TRUE(solved.estimate.found);
    EXPECT_TRUE(solved.estimate.x.allFinite());
    EXPECT_TRUE(is_covariance(solved.estimate.P, 1e-6));
    EXPECT_TRUE(h == Handling::ignored || solved.error_m < 3000.0) << solved.error_m;
  }
}

// NEES of the state with the source's frequency: chi-square with five degrees of freedom each.
TEST(FrequencyChanges, EstimateWithItsSourceIsConsistent) {
  constexpr int kRuns = 200;
  double nees = 0.0, boastful = 0.0;
  for (std::uint64_t run = 0; run < kRuns; ++run) {
    BearingFrequencyWindows windows = KimSong::windows(run, jump(30.0, 600.0, 800.0));
    const BatchEstimate estimate = solve(windows).estimate;
    const SourceFrequency source = windows.frequencies.source(0, estimate.x, estimate.time_s);
    Eigen::Matrix<double, 5, 1> error;
    error << KimSong::target(1050.0) - estimate.x, 100.0 - source.frequency_hz;
    const Eigen::Matrix<double, 5, 5> P = covariance_with(estimate.P, source);
    nees += mahalanobis_squared(P, error);
    boastful += mahalanobis_squared(Eigen::Matrix<double, 5, 5>(0.1 * P), error);
  }
  EXPECT_FALSE(testing::is_too_small(nees, 5.0 * kRuns)) << nees / kRuns;
  EXPECT_FALSE(testing::is_too_large(nees, 5.0 * kRuns)) << nees / kRuns;
  EXPECT_TRUE(testing::is_too_large(boastful, 5.0 * kRuns)) << boastful / kRuns;
}

TEST(FrequencyChanges, WithoutFrequenciesTheBearingsSpeak) {
  BearingFrequencyWindows windows = KimSong::windows(4);
  windows.frequencies.clear();
  TargetMotionBatch batch;
  const Solved solved = solve(windows);
  EXPECT_EQ(solved.estimate.x, batch.solve(windows.bearings).x);
  EXPECT_TRUE(solved.changes.empty());
}

}  // namespace
}  // namespace truebearing::frequency_changes_test
