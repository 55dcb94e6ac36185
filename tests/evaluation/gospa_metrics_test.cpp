// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/gospa_metrics.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/angle_comparison.hpp"
#include "tests/support/metric_runs.hpp"
#include "truebearing/evaluation/report.hpp"

namespace truebearing::gospa_metrics_test {
namespace {

using testing::figures;
using testing::find_metric;
using ::testing::HasSubstr;
using ::testing::Not;

const Scorer kScorer(angle_space(), angle_space());

ScoringRule rule() {
  ScoringRule made;
  made.assignment = AssignmentRule{"angle_deg", 5.0};
  made.families.push_back(gospa_metrics());
  return made;
}

// The sums over two steps.
RunScore run(double squared, double localisation, double missed, double false_tracks) {
  const auto kept = std::make_shared<GospaFigures>();
  kept->squared = squared;
  kept->localisation = localisation;
  kept->missed = missed;
  kept->false_tracks = false_tracks;
  kept->steps = 2.0;
  RunScore score;
  score.figures = {kept};
  return score;
}

TEST(GospaMetrics, ByHand) {
  const std::vector<RunScore> scores{run(20.0, 8.0, 3.0, 0.0), run(28.0, 4.0, 1.0, 2.0)};
  const std::vector<Metric> found = figures(*gospa_metrics(), kScorer, scores, rule());
  EXPECT_DOUBLE_EQ(find_metric(found, "gospa").value, std::sqrt(48.0 / 4.0));
  EXPECT_NEAR(find_metric(found, "gospa").se, 0.5 * (std::sqrt(14.0) - std::sqrt(10.0)), 1e-12);
  EXPECT_DOUBLE_EQ(find_metric(found, "gospa_localisation").value, std::sqrt(3.0));
  EXPECT_DOUBLE_EQ(find_metric(found, "missed_targets").value, 1.0);
  EXPECT_DOUBLE_EQ(find_metric(found, "missed_targets").se, 0.5 * (1.5 - 0.5));
  EXPECT_DOUBLE_EQ(find_metric(found, "false_tracks").value, 0.5);
  for (const Metric& metric : found) EXPECT_EQ(metric.table, MetricTable::tracks) << metric.name;
}

TEST(GospaMetrics, AreNoneWhereNobodyAssigns) {
  EXPECT_TRUE(figures(*gospa_metrics(), kScorer, {run(20.0, 8.0, 3.0, 0.0)}).empty());
  EXPECT_TRUE(figures(*gospa_metrics(), kScorer, {RunScore{}}, rule()).empty()) << "a tracker of other quantities";
}

TEST(GospaMetrics, ComeThroughAComparison) {
  const Comparison comparison = testing::angle_comparison(rule());
  EXPECT_NEAR(find_metric(comparison.trackers[2].metrics, "gospa").value, 0.0, 1e-9) << "numbers do not matter";
  EXPECT_NEAR(comparison.trackers[2].quantity("angle_deg")->rmse, 0.0, 1e-9);
  EXPECT_NEAR(find_metric(comparison.trackers[0].metrics, "gospa").value, 1.0, 1e-9);
  EXPECT_THAT(comparison_table(comparison), HasSubstr("missed targets"));
  EXPECT_THAT(comparison_json(comparison), Not(HasSubstr("clean")));
}

}  // namespace
}  // namespace truebearing::gospa_metrics_test
