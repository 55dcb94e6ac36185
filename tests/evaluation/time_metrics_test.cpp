#include "truebearing/evaluation/time_metrics.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/line_trackers.hpp"

namespace truebearing {
namespace {

using testing::kInfinity;
using testing::kNaN;

const Scorer kScorer(line_space(), line_space());

Recording recording(const std::vector<double>& times_s) {
  Recording made;
  made.truth.resize(1);
  for (const double time_s : times_s) {
    made.measurements.push_back(testing::position(time_s, 0.0));
    made.truth[0].x.emplace_back(Eigen::Vector2d::Zero());
  }
  return made;
}

// A run of one step that all times stand for, or of none.
RunScore run(double position, double nees, std::size_t times = 1) {
  RunScore score;
  score.error = {{position}, {0.1 * position}};
  score.nees = {nees};
  score.quantity_nees = {{nees}, {nees}};
  score.at_times.assign(times, TimeScore{.step = 0});
  return score;
}

RunScore off_by(double range_percent, double course_deg = 0.0, double speed_mps = 0.0) {
  RunScore score = run(1.0, 1.0);
  score.at_times[0].motion = {range_percent, course_deg, speed_mps};
  return score;
}

std::vector<const RunScore*> pointers(const std::vector<RunScore>& runs) {
  std::vector<const RunScore*> all;
  for (const RunScore& score : runs) all.push_back(&score);
  return all;
}

const Metric* find(const std::vector<Metric>& metrics, const std::string& name, std::optional<double> time_s) {
  for (const Metric& metric : metrics)
    if (metric.name == name && metric.time_s == time_s) return &metric;
  ADD_FAILURE() << "no metric " << name;
  return &metrics.front();
}

TEST(StepsAt, AreTheLastUntilThen) {
  EXPECT_EQ(steps_at(recording({0.0, 4.0, 8.0}), {0.0, 3.9, 4.0, 7.9999995, 8.0, 12.0}),
            (std::vector<int>{0, 0, 1, 2, 2, 2}));
  EXPECT_EQ(steps_at(recording({5.0, 9.0}), {4.0, 13.0, 13.1, 500.0}), (std::vector<int>{-1, 1, -1, -1}))
      << "before the first measurement, and after a run has ended";
  EXPECT_EQ(steps_at(recording({1.0, 1.0}), {1.0}), (std::vector<int>{1})) << "of two at once, the second";
  Recording unknown = recording({0.0, 4.0});
  unknown.truth[0].x[1].setConstant(kNaN);
  EXPECT_EQ(steps_at(unknown, {0.0, 4.0}), (std::vector<int>{0, -1}));
}

TEST(TimeMetrics, OfQuantitiesByHand) {
  const std::vector<RunScore> runs{run(3.0, 1.0), run(4.0, 7.0), run(11.0, 4.0)};
  const ScoringRule rule{.from_step = 1, .loss_thresholds = {{"position_m", 10.0}}, .times_s = {60.0}};
  const std::vector<Metric> metrics = time_metrics(kScorer, pointers(runs), rule);
  const Metric& rmse = *find(metrics, "position_rmse", 60.0);
  EXPECT_EQ(rmse.unit, "m");
  EXPECT_DOUBLE_EQ(rmse.value, std::sqrt((9.0 + 16.0 + 121.0) / 3.0));
  const double a = std::sqrt(68.5), b = std::sqrt(65.0), c = std::sqrt(12.5), mean = (a + b + c) / 3.0;
  EXPECT_NEAR(rmse.se,
              std::sqrt(2.0 / 3.0 * ((a - mean) * (a - mean) + (b - mean) * (b - mean) + (c - mean) * (c - mean))), 1e-12);
  EXPECT_DOUBLE_EQ(find(metrics, "position_median", 60.0)->value, 4.0);
  EXPECT_EQ(find(metrics, "velocity_rmse", 60.0)->unit, "m/s");
  EXPECT_DOUBLE_EQ(find(metrics, "nees", 60.0)->value, 4.0);
  EXPECT_DOUBLE_EQ(find(metrics, "coverage95", 60.0)->value, 2.0 / 3.0) << "7 is beyond 5.99";
  EXPECT_DOUBLE_EQ(find(metrics, "loss_rate", 60.0)->value, 1.0 / 3.0);
  EXPECT_DOUBLE_EQ(find(metrics, "loss_rate", 60.0)->se, std::sqrt(2.0 / 27.0));
  EXPECT_EQ(find(metrics, "missing_share", 60.0)->value, 0.0);
}

TEST(TimeMetrics, RunsWithoutAnEstimateAreCountedAndLeftOut) {
  RunScore absent = run(kNaN, kNaN);
  absent.at_times[0].step = -1;  // its truth is unknown: nobody's fault
  const std::vector<RunScore> runs{run(3.0, 1.0), run(kNaN, kNaN), run(kInfinity, kInfinity), run(4.0, 2.0), absent};
  const ScoringRule rule{.from_step = 1, .loss_thresholds = {{"position_m", 10.0}}, .times_s = {60.0}};
  const std::vector<Metric> metrics = time_metrics(kScorer, pointers(runs), rule);
  EXPECT_DOUBLE_EQ(find(metrics, "position_rmse", 60.0)->value, std::sqrt(12.5));
  EXPECT_DOUBLE_EQ(find(metrics, "nees", 60.0)->value, 1.5);
  EXPECT_DOUBLE_EQ(find(metrics, "missing_share", 60.0)->value, 0.5);
  EXPECT_DOUBLE_EQ(find(metrics, "loss_rate", 60.0)->value, 0.5);
}

TEST(TimeMetrics, EachTimeHasItsOwnStep) {
  RunScore score = run(3.0, 1.0, 2);
  score.error = {{3.0, 8.0}, {0.0, 0.0}};
  score.nees = {1.0, 2.0};
  score.at_times[1].step = 1;
  const std::vector<RunScore> runs{score};
  const ScoringRule rule{.from_step = 1, .loss_thresholds = {}, .times_s = {60.0, 90.0}};
  const std::vector<Metric> metrics = time_metrics(kScorer, pointers(runs), rule);
  EXPECT_EQ(find(metrics, "position_rmse", 60.0)->value, 3.0);
  EXPECT_EQ(find(metrics, "position_rmse", 90.0)->value, 8.0);
  for (const Metric& metric : metrics) EXPECT_NE(metric.name, "loss_rate") << "nobody said what lost is";
  EXPECT_TRUE(time_metrics(kScorer, pointers(runs), {}).empty());
}

TEST(TimeMetrics, OfTheTargetsMotionByHand) {
  const std::vector<RunScore> runs{off_by(-10.0, 3.0, 1.0), off_by(30.0, -4.0, -1.0), off_by(4.0, 0.0, 2.0)};
  const ScoringRule rule{.from_step = 1, .loss_thresholds = {}, .times_s = {60.0}, .target_motion = true};
  const std::vector<Metric> metrics = time_metrics(kScorer, pointers(runs), rule);
  EXPECT_DOUBLE_EQ(find(metrics, "range_error_mean", 60.0)->value, 8.0);
  EXPECT_DOUBLE_EQ(find(metrics, "range_error_std", 60.0)->value, std::sqrt((18.0 * 18.0 + 22.0 * 22.0 + 16.0) / 2.0));
  EXPECT_DOUBLE_EQ(find(metrics, "range_error_mean", 60.0)->se,
                   find(metrics, "range_error_std", 60.0)->value / std::sqrt(3.0));
  EXPECT_DOUBLE_EQ(find(metrics, "range_error_rmse", 60.0)->value, std::sqrt((100.0 + 900.0 + 16.0) / 3.0));
  EXPECT_DOUBLE_EQ(find(metrics, "range_error_median", 60.0)->value, 10.0) << "of the sizes";
  EXPECT_DOUBLE_EQ(find(metrics, "course_error_rmse", 60.0)->value, std::sqrt(25.0 / 3.0));
  EXPECT_DOUBLE_EQ(find(metrics, "speed_error_rmse", 60.0)->value, std::sqrt(2.0));
  EXPECT_EQ(find(metrics, "time_to_20_percent", std::nullopt)->value, 60.0);
}

TEST(TimeMetrics, DivergedBaselinesHaveFiniteFigures) {
  const std::vector<RunScore> runs{off_by(-10.0), off_by(1e14), off_by(4.0), off_by(kNaN, kNaN, kNaN)};
  const ScoringRule rule{.from_step = 1, .loss_thresholds = {}, .times_s = {60.0}, .target_motion = true};
  const std::vector<Metric> metrics = time_metrics(kScorer, pointers(runs), rule);
  EXPECT_NEAR(find(metrics, "range_error_mean", 60.0)->value, 1e14 / 3.0, 10.0);
  EXPECT_NEAR(find(metrics, "range_error_std", 60.0)->value, 1e14 / std::sqrt(3.0), 1e3);
  EXPECT_EQ(find(metrics, "range_error_median", 60.0)->value, 10.0);
  EXPECT_TRUE(std::isnan(find(metrics, "time_to_20_percent", std::nullopt)->value)) << "never";
}

RunScore solved(double cost, int iterations = 0, int non_finite = 0) {
  RunScore score = run(1.0, 1.0);
  score.at_times[0].batch = BatchOutcome{cost, iterations, 225, non_finite};
  return score;
}

TEST(TimeMetrics, OfBatchEstimatorsAreOverRunsAndTimesAtWhichTheySolved) {
  const std::vector<RunScore> runs{solved(1.0, 10, 81), solved(1.0, 4, 0), run(1.0, 1.0)};
  const ScoringRule rule{.from_step = 1, .loss_thresholds = {}, .times_s = {60.0}};
  const std::vector<Metric> metrics = time_metrics(kScorer, pointers(runs), rule);
  EXPECT_DOUBLE_EQ(find(metrics, "non_finite_starts", std::nullopt)->value, 40.5);
  EXPECT_DOUBLE_EQ(find(metrics, "iterations", std::nullopt)->value, 7.0);
}

TEST(GlobalMinimumShare, CountsCostsThatAreNoHigherThanTheReferences) {
  const std::vector<RunScore> reference{solved(50.0), solved(50.0), solved(50.0), solved(50.0), run(1.0, 1.0)};
  const std::vector<RunScore> scores{solved(50.00004), solved(50.01), solved(49.0), solved(kNaN), solved(1.0)};
  const std::vector<Metric> share = global_minimum_share(pointers(scores), pointers(reference));
  ASSERT_EQ(share.size(), 1u);
  EXPECT_EQ(share[0].name, "global_minimum_share");
  EXPECT_DOUBLE_EQ(share[0].value, 0.5) << "of the four at which the reference solved";
  const std::vector<RunScore> filter(5, run(1.0, 1.0));
  EXPECT_TRUE(global_minimum_share(pointers(filter), pointers(reference)).empty()) << "it has no minimum";
}

TEST(TimedDifferences, AreOfErrorNormsOverTheRunsThatBothHave) {
  const std::vector<RunScore> a{run(3.0, 1.0), run(5.0, 1.0), run(kNaN, 1.0)};
  const std::vector<RunScore> b{run(1.0, 1.0), run(6.0, 1.0), run(2.0, 1.0)};
  const ScoringRule rule{.from_step = 1, .loss_thresholds = {}, .times_s = {60.0}};
  const std::vector<TimedDifference> differences =
      timed_differences(kScorer, pointers(a), kScorer, pointers(b), rule);
  ASSERT_EQ(differences.size(), 2u);
  EXPECT_EQ(differences[0].quantity, "position_m");
  EXPECT_EQ(differences[0].time_s, 60.0);
  EXPECT_DOUBLE_EQ(differences[0].mean, 0.5);
  EXPECT_DOUBLE_EQ(differences[0].se, 1.5);
}

}  // namespace
}  // namespace truebearing
