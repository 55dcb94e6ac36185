#include "truebearing/evaluation/track_metrics.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/support/angle_tracks.hpp"
#include "tests/support/line_trackers.hpp"
#include "truebearing/evaluation/comparison.hpp"
#include "truebearing/evaluation/report.hpp"

namespace truebearing {
namespace {

using ::testing::HasSubstr;
using testing::kNaN;
using ::testing::Not;

const Scorer kScorer(angle_space(), angle_space());

ScoringRule tracks_rule() {
  ScoringRule rule;
  rule.tracks = TrackRule{.quantity = "angle_deg", .bad = 3.0, .last_steps = 2, .excursion = 6.0};
  return rule;
}

RunScore run(std::vector<double> angle, std::vector<double> rate, TrackOutcome outcome) {
  RunScore score;
  score.targets = 2;
  score.error = {std::move(angle), std::move(rate)};
  score.tracks = outcome;
  return score;
}

// Clean, swapped, lost, clean, strayed.
std::vector<RunScore> runs() {
  return {run({1, 1, 3, kNaN}, {1, 1, 1, 1}, {}), run({20, 20, 20, 20}, {9, 9, 9, 9}, {2, 1, true}),
          run({10, 0, 0, 0}, {9, 0, 0, 0}, {0, 1, true}), run({2, 2, 2, 2}, {3, 3, 3, 3}, {}),
          run({7, 0, 0, 0}, {0, 0, 0, 0}, {0, 0, true})};
}

std::vector<const RunScore*> pointers(const std::vector<RunScore>& scores) {
  std::vector<const RunScore*> all;
  for (const RunScore& score : scores) all.push_back(&score);
  return all;
}

Metric find(const std::vector<Metric>& all, const std::string& name) {
  for (const Metric& metric : all)
    if (metric.name == name) return metric;
  ADD_FAILURE() << "no " << name;
  return {};
}

TEST(TrackMetrics, ByHand) {
  const std::vector<RunScore> scores = runs();
  const std::vector<Metric> found = track_metrics(kScorer, pointers(scores), tracks_rule());
  EXPECT_EQ(find(found, "swap_runs").value, 1.0);
  EXPECT_EQ(find(found, "swap_runs").unit, "runs");
  EXPECT_EQ(find(found, "lost_runs").value, 1.0) << "the run that swapped is none";
  EXPECT_EQ(find(found, "excursion_runs").value, 3.0);
  EXPECT_EQ(find(found, "clean_runs").value, 2.0);
  EXPECT_DOUBLE_EQ(find(found, "bad_share").value, 0.4);
  EXPECT_DOUBLE_EQ(find(found, "bad_share").se, std::sqrt(0.4 * 0.6 / 5.0));
  EXPECT_DOUBLE_EQ(find(found, "clean_mse").value, (1 + 1 + 9 + 4 * 4) / 7.0);
  EXPECT_DOUBLE_EQ(find(found, "clean_mse").se, 0.5 * std::abs(11.0 / 3.0 - 4.0)) << "over runs";
  EXPECT_EQ(find(found, "clean_mse").unit, "deg^2");
  EXPECT_DOUBLE_EQ(find(found, "all_mse").value, (11 + 1600 + 100 + 16 + 49) / 19.0);
  EXPECT_DOUBLE_EQ(find(found, "rate_clean_mse").value, (4 + 36) / 8.0);
  EXPECT_EQ(find(found, "rate_clean_mse").unit, "(deg/s)^2");
  for (const Metric& metric : found) EXPECT_TRUE(is_track_metric(metric.name)) << metric.name;
  EXPECT_FALSE(is_track_metric("turn_delay"));
}

TEST(TrackMetrics, WithoutCleanRunsHaveNoCleanError) {
  const std::vector<RunScore> scores{runs()[1]};
  const std::vector<Metric> found = track_metrics(kScorer, pointers(scores), tracks_rule());
  EXPECT_TRUE(std::isnan(find(found, "clean_mse").value));
  EXPECT_EQ(find(found, "all_mse").value, 400.0);
}

TEST(TrackMetrics, AreNoneWhereNobodyAsks) {
  EXPECT_TRUE(track_metrics(kScorer, {}, {}).empty());
  EXPECT_TRUE(gospa_metrics({}, {}).empty());
}

TEST(GospaMetrics, ByHand) {
  std::vector<RunScore> scores(2);
  scores[0].gospa = GospaSum{.squared = 20.0, .localisation = 8.0, .missed = 3.0, .false_tracks = 0.0, .steps = 2.0};
  scores[1].gospa = GospaSum{.squared = 28.0, .localisation = 4.0, .missed = 1.0, .false_tracks = 2.0, .steps = 2.0};
  ScoringRule rule;
  rule.gospa = GospaRule{"angle_deg", 5.0};
  const std::vector<Metric> found = gospa_metrics(pointers(scores), rule);
  EXPECT_DOUBLE_EQ(find(found, "gospa").value, std::sqrt(48.0 / 4.0));
  EXPECT_NEAR(find(found, "gospa").se, 0.5 * (std::sqrt(14.0) - std::sqrt(10.0)), 1e-12);
  EXPECT_DOUBLE_EQ(find(found, "gospa_localisation").value, std::sqrt(3.0));
  EXPECT_DOUBLE_EQ(find(found, "missed_targets").value, 1.0);
  EXPECT_DOUBLE_EQ(find(found, "missed_targets").se, 0.5 * (1.5 - 0.5));
  EXPECT_DOUBLE_EQ(find(found, "false_tracks").value, 0.5);
  for (const Metric& metric : found) EXPECT_TRUE(is_track_metric(metric.name)) << metric.name;
}

TEST(CleanDifferences, AreOfRunsThatAreCleanWithBoth) {
  std::vector<RunScore> a = runs(), b = runs();
  b[0] = run({0, 0, 0, 0}, {0, 0, 0, 0}, {});
  b[1] = run({0, 0, 0, 0}, {0, 0, 0, 0}, {});  // a swapped here
  b[3] = run({1, 1, 3, 3}, {3, 3, 3, 3}, {});
  for (std::vector<RunScore>* scores : {&a, &b})
    for (RunScore& score : *scores) score.phase = {0, 0, 1, 1};
  const std::vector<CleanDifference> found = clean_differences(kScorer, pointers(a), kScorer, pointers(b));
  ASSERT_EQ(found.size(), 6u) << "two quantities, over all steps and in two phases";
  EXPECT_EQ(found[0].quantity, "angle_deg");
  EXPECT_EQ(found[0].phase, -1);
  const double first = 11.0 / 3.0 - 0.0, fourth = 4.0 - 5.0;
  EXPECT_NEAR(found[0].mean, 0.5 * (first + fourth), 1e-12);
  EXPECT_NEAR(found[0].se, 0.5 * std::abs(first - fourth), 1e-12);
  EXPECT_EQ(found[1].phase, 0);
  EXPECT_NEAR(found[1].mean, 0.5 * (1.0 + (4.0 - 1.0)), 1e-12);
  EXPECT_NEAR(found[2].mean, 0.5 * (9.0 + (4.0 - 9.0)), 1e-12) << "of a phase, the steps that are scored";
  EXPECT_EQ(found[3].quantity, "rate_degps");
  a[0].tracks.reset();
  EXPECT_TRUE(clean_differences(kScorer, pointers(a), kScorer, pointers(b)).empty());
}

Comparison compared(const ScoringRule& rule) {
  Recording recording = testing::angle_recording({{0, {0, 0, 0, 0}}, {1, {20, 20, 20, 20}}});
  recording.phases = {"apart", "crossing"};
  recording.truth[0].phase = {0, 0, 1, 1};
  recording.truth[1].phase = {0, 1, 1, 1};
  Ensemble ensemble;
  ensemble.add("near", std::make_unique<testing::ToldTracker>(
                           testing::AnglesOfTracks{{0, {1, 1, 1, 1}}, {1, {20, 20, 20, 20}}}));
  ensemble.add("nearer", std::make_unique<testing::ToldTracker>(
                             testing::AnglesOfTracks{{0, {0, 0, 0.5, 0.5}}, {1, {20, 20, 20, 20}}}));
  ensemble.add("swapped", std::make_unique<testing::ToldTracker>(
                              testing::AnglesOfTracks{{0, {0, 0, 20, 20}}, {1, {20, 20, 0, 0}}}));
  TrackerSet set(std::move(ensemble));
  for (const char* name : {"near", "nearer", "swapped"}) set.show_member(name);
  ComparisonOptions options;
  options.runs = 3;
  options.scoring = rule;
  options.pairs = {{"nearer", "near"}};
  const testing::AngleScenario scenario(recording);
  return compare(set, {{"two", &scenario}}, options);
}

TEST(TrackMetrics, ComeThroughAComparison) {
  const Comparison comparison = compared(tracks_rule());
  EXPECT_EQ(find(comparison.trackers[2].metrics, "swap_runs").value, 3.0);
  EXPECT_NEAR(find(comparison.trackers[2].metrics, "all_mse").value, 200.0, 1e-9);
  EXPECT_NEAR(find(comparison.trackers[0].metrics, "clean_mse").value, 0.5, 1e-12);
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

TEST(GospaMetrics, ComeThroughAComparison) {
  ScoringRule rule;
  rule.gospa = GospaRule{"angle_deg", 5.0};
  const Comparison comparison = compared(rule);
  EXPECT_NEAR(find(comparison.trackers[2].metrics, "gospa").value, 0.0, 1e-9) << "numbers do not matter";
  EXPECT_NEAR(comparison.trackers[2].quantity("angle_deg")->rmse, 0.0, 1e-9);
  EXPECT_NEAR(find(comparison.trackers[0].metrics, "gospa").value, 1.0, 1e-9);
  EXPECT_THAT(comparison_table(comparison), HasSubstr("missed targets"));
  EXPECT_THAT(comparison_json(comparison), Not(HasSubstr("clean")));
}

TEST(TrackMetrics, OrdinaryComparisonsAreAsTheyWere) {
  const Comparison comparison = compared({});
  EXPECT_THAT(comparison_json(comparison), Not(HasSubstr("clean")));
  EXPECT_THAT(comparison_table(comparison), Not(HasSubstr("tracks")));
}

}  // namespace
}  // namespace truebearing
