// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/target_motion_metrics.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/line_trackers.hpp"
#include "tests/support/metric_runs.hpp"

#include "truebearing/core/constants.hpp"

namespace truebearing::target_motion_metrics_test {
namespace {

using testing::figures;
using testing::find_metric;

const Scorer kScorer(plane_space(), plane_space());

// A run that is so far off at its only time.
RunScore off_by(double range_percent, double course_deg = 0.0, double speed_mps = 0.0) {
  const auto kept = std::make_shared<TargetMotionFigures>();
  kept->at_times = {{range_percent, course_deg, speed_mps}};
  RunScore score;
  score.figures = {kept};
  return score;
}

TEST(TargetMotionMetrics, ByHand) {
  const std::vector<RunScore> runs{off_by(-10.0, 3.0, 1.0), off_by(30.0, -4.0, -1.0), off_by(4.0, 0.0, 2.0)};
  const ScoringRule rule{.from_step = 1, .loss_thresholds = {}, .times_s = {60.0}};
  const std::vector<Metric> metrics = figures(*target_motion_metrics(), kScorer, runs, rule);
  EXPECT_DOUBLE_EQ(find_metric(metrics, "range_error_mean", 60.0).value, 8.0);
  EXPECT_DOUBLE_EQ(find_metric(metrics, "range_error_std", 60.0).value,
                   std::sqrt((18.0 * 18.0 + 22.0 * 22.0 + 16.0) / 2.0));
  EXPECT_DOUBLE_EQ(find_metric(metrics, "range_error_mean", 60.0).se,
                   find_metric(metrics, "range_error_std", 60.0).value / std::sqrt(3.0));
  EXPECT_DOUBLE_EQ(find_metric(metrics, "range_error_rmse", 60.0).value, std::sqrt((100.0 + 900.0 + 16.0) / 3.0));
  EXPECT_DOUBLE_EQ(find_metric(metrics, "range_error_median", 60.0).value, 10.0) << "of the sizes";
  EXPECT_DOUBLE_EQ(find_metric(metrics, "course_error_rmse", 60.0).value, std::sqrt(25.0 / 3.0));
  EXPECT_DOUBLE_EQ(find_metric(metrics, "speed_error_rmse", 60.0).value, std::sqrt(2.0));
  EXPECT_EQ(find_metric(metrics, "time_to_20_percent").value, 60.0);
}

TEST(TargetMotionMetrics, DivergedBaselinesHaveFiniteFigures) {
  const std::vector<RunScore> runs{off_by(-10.0), off_by(1e14), off_by(4.0), off_by(kNaN, kNaN, kNaN)};
  const ScoringRule rule{.from_step = 1, .loss_thresholds = {}, .times_s = {60.0}};
  const std::vector<Metric> metrics = figures(*target_motion_metrics(), kScorer, runs, rule);
  EXPECT_NEAR(find_metric(metrics, "range_error_mean", 60.0).value, 1e14 / 3.0, 10.0);
  EXPECT_NEAR(find_metric(metrics, "range_error_std", 60.0).value, 1e14 / std::sqrt(3.0), 1e3);
  EXPECT_EQ(find_metric(metrics, "range_error_median", 60.0).value, 10.0);
  EXPECT_TRUE(std::isnan(find_metric(metrics, "time_to_20_percent").value)) << "never";
}

}  // namespace
}  // namespace truebearing::target_motion_metrics_test
