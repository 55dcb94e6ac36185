// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/time_metrics.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/line_trackers.hpp"
#include "tests/support/metric_runs.hpp"

#include "truebearing/core/constants.hpp"

namespace truebearing::time_metrics_test {
namespace {

using testing::figures;
using testing::find_metric;

const Scorer kScorer(line_space(), line_space());

// A run of one step that all times stand for, or of none.
RunScore run(double position, double nees, std::size_t times = 1) {
  RunScore score;
  score.error = {{position}, {0.1 * position}};
  score.nees = {nees};
  score.quantity_nees = {{nees}, {nees}};
  score.time_steps.assign(times, 0);
  return score;
}

TEST(TimeMetrics, OfQuantitiesByHand) {
  const std::vector<RunScore> runs{run(3.0, 1.0), run(4.0, 7.0), run(11.0, 4.0)};
  const ScoringRule rule{.from_step = 1, .loss_thresholds = {{"position_m", 10.0}}, .times_s = {60.0}};
  const std::vector<Metric> metrics = figures(*time_metrics(), kScorer, runs, rule);
  const Metric rmse = find_metric(metrics, "position_rmse", 60.0);
  EXPECT_EQ(rmse.unit, "m");
  EXPECT_DOUBLE_EQ(rmse.value, std::sqrt((9.0 + 16.0 + 121.0) / 3.0));
  const double a = std::sqrt(68.5), b = std::sqrt(65.0), c = std::sqrt(12.5), mean = (a + b + c) / 3.0;
  EXPECT_NEAR(rmse.se,
              std::sqrt(2.0 / 3.0 * ((a - mean) * (a - mean) + (b - mean) * (b - mean) + (c - mean) * (c - mean))),
              1e-12);
  EXPECT_DOUBLE_EQ(find_metric(metrics, "position_median", 60.0).value, 4.0);
  EXPECT_EQ(find_metric(metrics, "velocity_rmse", 60.0).unit, "m/s");
  EXPECT_DOUBLE_EQ(find_metric(metrics, "nees", 60.0).value, 4.0);
  EXPECT_DOUBLE_EQ(find_metric(metrics, "coverage95", 60.0).value, 2.0 / 3.0) << "7 is beyond 5.99";
  EXPECT_DOUBLE_EQ(find_metric(metrics, "loss_rate", 60.0).value, 1.0 / 3.0);
  EXPECT_DOUBLE_EQ(find_metric(metrics, "loss_rate", 60.0).se, std::sqrt(1.5 * 2.5 / 5.0) / 4.0);
  EXPECT_EQ(find_metric(metrics, "missing_share", 60.0).value, 0.0);
}

TEST(TimeMetrics, RunsWithoutAnEstimateAreCountedAndLeftOut) {
  RunScore absent = run(kNaN, kNaN);
  absent.time_steps[0] = -1;  // its truth is unknown: nobody's fault
  const std::vector<RunScore> runs{run(3.0, 1.0), run(kNaN, kNaN), run(kInfinity, kInfinity), run(4.0, 2.0), absent};
  const ScoringRule rule{.from_step = 1, .loss_thresholds = {{"position_m", 10.0}}, .times_s = {60.0}};
  const std::vector<Metric> metrics = figures(*time_metrics(), kScorer, runs, rule);
  EXPECT_DOUBLE_EQ(find_metric(metrics, "position_rmse", 60.0).value, std::sqrt(12.5));
  EXPECT_DOUBLE_EQ(find_metric(metrics, "nees", 60.0).value, 1.5);
  EXPECT_DOUBLE_EQ(find_metric(metrics, "missing_share", 60.0).value, 0.5);
  EXPECT_DOUBLE_EQ(find_metric(metrics, "loss_rate", 60.0).value, 0.5);
}

TEST(TimeMetrics, EachTimeHasItsOwnStep) {
  RunScore score = run(3.0, 1.0, 2);
  score.error = {{3.0, 8.0}, {0.0, 0.0}};
  score.nees = {1.0, 2.0};
  score.time_steps[1] = 1;
  const std::vector<RunScore> runs{score};
  const ScoringRule rule{.from_step = 1, .loss_thresholds = {}, .times_s = {60.0, 90.0}};
  const std::vector<Metric> metrics = figures(*time_metrics(), kScorer, runs, rule);
  EXPECT_EQ(find_metric(metrics, "position_rmse", 60.0).value, 3.0);
  EXPECT_EQ(find_metric(metrics, "position_rmse", 90.0).value, 8.0);
  for (const Metric& metric : metrics) EXPECT_NE(metric.name, "loss_rate") << "nobody said what lost is";
  EXPECT_TRUE(figures(*time_metrics(), kScorer, runs).empty());
}

TEST(TimeMetrics, PairedDifferencesAreOfErrorNormsOverTheRunsThatBothHave) {
  const std::vector<RunScore> a{run(3.0, 1.0), run(5.0, 1.0), run(kNaN, 1.0)};
  const std::vector<RunScore> b{run(1.0, 1.0), run(6.0, 1.0), run(2.0, 1.0)};
  const ScoringRule rule{.from_step = 1, .loss_thresholds = {}, .times_s = {60.0}};
  const std::vector<PairedDifference> differences = testing::paired(*time_metrics(), kScorer, a, b, rule);
  ASSERT_EQ(differences.size(), 2u);
  EXPECT_EQ(differences[0].quantity, "position_m");
  EXPECT_EQ(differences[0].time_s, 60.0);
  EXPECT_DOUBLE_EQ(differences[0].mean, 0.5);
  EXPECT_DOUBLE_EQ(differences[0].se, 1.5);
}

}  // namespace
}  // namespace truebearing::time_metrics_test
