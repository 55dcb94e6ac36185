// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/track_metrics.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/support/angle_comparison.hpp"
#include "tests/support/line_trackers.hpp"
#include "tests/support/metric_runs.hpp"
#include "truebearing/core/constants.hpp"
#include "truebearing/evaluation/report.hpp"

namespace truebearing::track_metrics_test {
namespace {

using testing::figures;
using testing::find_metric;
using ::testing::HasSubstr;
using ::testing::Not;

const Scorer kScorer(angle_space(), angle_space());

const TrackRule kRule{.quantity = "angle_deg", .bad = 3.0, .last_steps = 2, .excursion = 6.0};

RunScore run(std::vector<double> angle, std::vector<double> rate, TrackOutcome outcome) {
  const auto kept = std::make_shared<TrackFigures>();
  kept->outcome = outcome;
  kept->phases = {"apart"};
  RunScore score;
  score.targets = 2;
  score.error = {std::move(angle), std::move(rate)};
  score.figures = {kept};
  return score;
}

// Clean, swapped, lost, clean, strayed.
std::vector<RunScore> runs() {
  return {run({1, 1, 3, kNaN}, {1, 1, 1, 1}, {}), run({20, 20, 20, 20}, {9, 9, 9, 9}, {2, 1, true}),
          run({10, 0, 0, 0}, {9, 0, 0, 0}, {0, 1, true}), run({2, 2, 2, 2}, {3, 3, 3, 3}, {}),
          run({7, 0, 0, 0}, {0, 0, 0, 0}, {0, 0, true})};
}

TEST(TrackMetrics, ByHand) {
  const std::vector<RunScore> scores = runs();
  const std::vector<Metric> found = figures(*track_metrics(kRule), kScorer, scores);
  EXPECT_EQ(find_metric(found, "swap_runs").value, 1.0);
  EXPECT_EQ(find_metric(found, "swap_runs").unit, "runs");
  EXPECT_EQ(find_metric(found, "lost_runs").value, 1.0) << "the run that swapped is none";
  EXPECT_EQ(find_metric(found, "excursion_runs").value, 3.0);
  EXPECT_EQ(find_metric(found, "clean_runs").value, 2.0);
  EXPECT_DOUBLE_EQ(find_metric(found, "bad_share").value, 0.4);
  EXPECT_DOUBLE_EQ(find_metric(found, "bad_share").se, std::sqrt(2.5 * 3.5 / 7.0) / 6.0);
  EXPECT_DOUBLE_EQ(find_metric(found, "clean_mse").value, (1 + 1 + 9 + 4 * 4) / 7.0);
  EXPECT_DOUBLE_EQ(find_metric(found, "clean_mse").se, 0.5 * std::abs(11.0 / 3.0 - 4.0)) << "over runs";
  EXPECT_EQ(find_metric(found, "clean_mse").unit, "deg^2");
  EXPECT_DOUBLE_EQ(find_metric(found, "all_mse").value, (11 + 1600 + 100 + 16 + 49) / 19.0);
  EXPECT_DOUBLE_EQ(find_metric(found, "rate_clean_mse").value, (4 + 36) / 8.0);
  EXPECT_EQ(find_metric(found, "rate_clean_mse").unit, "(deg/s)^2");
  for (const Metric& metric : found) EXPECT_EQ(metric.table, MetricTable::tracks) << metric.name;
}

TEST(TrackMetrics, WithoutCleanRunsHaveNoCleanError) {
  const std::vector<RunScore> scores{runs()[1]};
  const std::vector<Metric> found = figures(*track_metrics(kRule), kScorer, scores);
  EXPECT_TRUE(std::isnan(find_metric(found, "clean_mse").value));
  EXPECT_EQ(find_metric(found, "all_mse").value, 400.0);
}

TEST(TrackMetrics, AreNoneOfATrackerThatDoesNotEstimateTheQuantity) {
  const Scorer rates(angle_space(), state_space_of_components({"rate_radps"}));
  EXPECT_TRUE(figures(*track_metrics(kRule), rates, {RunScore{}}).empty());
}

TEST(TrackMetrics, PairedDifferencesAreOfRunsThatAreCleanWithBoth) {
  std::vector<RunScore> a = runs(), b = runs();
  b[0] = run({0, 0, 0, 0}, {0, 0, 0, 0}, {});
  b[1] = run({0, 0, 0, 0}, {0, 0, 0, 0}, {});  // a swapped here
  b[3] = run({1, 1, 3, 3}, {3, 3, 3, 3}, {});
  for (std::vector<RunScore>* scores : {&a, &b})
    for (RunScore& score : *scores) score.phase = {0, 0, 1, 1};
  const std::vector<PairedDifference> found = testing::paired(*track_metrics(kRule), kScorer, a, b);
  ASSERT_EQ(found.size(), 6u) << "two quantities, over all steps and in two phases";
  EXPECT_EQ(found[0].quantity, "angle_deg2_clean");
  EXPECT_EQ(found[0].title, "angle deg^2");
  const double first = 11.0 / 3.0 - 0.0, fourth = 4.0 - 5.0;
  EXPECT_NEAR(found[0].mean, 0.5 * (first + fourth), 1e-12);
  EXPECT_NEAR(found[0].se, 0.5 * std::abs(first - fourth), 1e-12);
  EXPECT_EQ(found[1].quantity, "angle_deg2_clean_apart");
  EXPECT_EQ(found[1].title, "angle deg^2, apart");
  EXPECT_NEAR(found[1].mean, 0.5 * (1.0 + (4.0 - 1.0)), 1e-12);
  EXPECT_NEAR(found[2].mean, 0.5 * (9.0 + (4.0 - 9.0)), 1e-12) << "of a phase, the steps that are scored";
  EXPECT_EQ(found[2].quantity, "angle_deg2_clean_phase 2") << "which has no name";
  EXPECT_EQ(found[3].quantity, "rate_degps2_clean");
  a[0].figures.clear();
  EXPECT_TRUE(testing::paired(*track_metrics(kRule), kScorer, a, b).empty());
}

TEST(TrackMetrics, ComeThroughAComparison) {
  ScoringRule rule;
  rule.families.push_back(track_metrics(kRule));
  const Comparison comparison = testing::angle_comparison(rule);
  EXPECT_EQ(find_metric(comparison.trackers[2].metrics, "swap_runs").value, 3.0);
  EXPECT_NEAR(find_metric(comparison.trackers[2].metrics, "all_mse").value, 200.0, 1e-9);
  EXPECT_NEAR(find_metric(comparison.trackers[0].metrics, "clean_mse").value, 0.5, 1e-12);
  EXPECT_NEAR(comparison.trackers[0].quantity("angle_deg")->phases[1].rmse, std::sqrt(2.0 / 5.0), 1e-12);

  const nlohmann::json report = nlohmann::json::parse(comparison_json(comparison));
  const nlohmann::json& paired = report["paired"]["nearer - near"];
  EXPECT_NEAR(paired["angle_deg2_clean"]["mean"].get<double>(), 0.5 / 8.0 - 0.5, 1e-12);
  EXPECT_NEAR(paired["angle_deg2_clean_crossing"]["mean"].get<double>(), (0.5 - 2.0) / 5.0, 1e-12);
  EXPECT_EQ(paired["rate_degps2_clean"]["mean"], 0.0);
  EXPECT_TRUE(paired.contains("angle_deg")) << "that of the RMSE, over all runs";

  const std::string table = comparison_table(comparison);
  for (const char* text : {"clean mse deg^2", "all mse deg^2", "swap runs", "lost runs", "excursion runs",
                           "rate clean mse (deg/s)^2", "angle deg^2, crossing", "runs clean with both"})
    EXPECT_THAT(table, HasSubstr(text));
  EXPECT_EQ(table.find("swap runs"), table.rfind("swap runs")) << "once, not also among the other figures";
  EXPECT_THAT(table, Not(HasSubstr("gospa")));
}

TEST(TrackMetrics, OrdinaryComparisonsAreAsTheyWere) {
  const Comparison comparison = testing::angle_comparison({});
  EXPECT_THAT(comparison_json(comparison), Not(HasSubstr("clean")));
  EXPECT_THAT(comparison_table(comparison), Not(HasSubstr("tracks")));
}

}  // namespace
}  // namespace truebearing::track_metrics_test
