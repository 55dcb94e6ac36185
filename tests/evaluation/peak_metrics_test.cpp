// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/error_message.hpp"
#include "tests/support/line_trackers.hpp"
#include "tests/support/metric_runs.hpp"
#include "truebearing/core/constants.hpp"
#include "truebearing/evaluation/comparison.hpp"
#include "truebearing/evaluation/metric_registry.hpp"
#include "truebearing/evaluation/report.hpp"

namespace truebearing::peak_metrics_test {
namespace {

using testing::error_message;
using testing::find_metric;
using ::testing::HasSubstr;

const Scorer kScorer(line_space(), line_space());

ScoringRule read(const std::string& text) {
  const SharedTable table = parse_toml(text, "study.toml");
  TableReader reader(table, "study.toml", "scoring");
  ScoringRule rule;
  read_metrics(reader, line_space(), rule);
  reader.finish();
  return rule;
}

RunScore run(std::vector<double> position, std::vector<double> velocity) {
  RunScore score;
  score.error = {std::move(position), std::move(velocity)};
  return score;
}

TEST(PeakMetrics, ByHand) {
  const std::vector<RunScore> runs{run({3.0, 8.0, kNaN}, {1.0, 0.5, kNaN}), run({2.0, kNaN, 1.0}, {3.0, kNaN, 4.0}),
                                   run({kNaN, kNaN, kNaN}, {kNaN, kNaN, kNaN})};
  const ScoringRule rule = read("peak_error = true");
  ASSERT_EQ(rule.families.size(), usual_metrics().size() + 1);
  const std::vector<Metric> found = testing::figures(*rule.families.back(), kScorer, runs, rule);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(find_metric(found, "position_peak_error").value, 5.0) << "of 8 and 2; the last run has none";
  EXPECT_EQ(find_metric(found, "position_peak_error").se, 3.0);
  EXPECT_EQ(find_metric(found, "position_peak_error").unit, "m");
  EXPECT_EQ(find_metric(found, "velocity_peak_error").value, 2.5);
  EXPECT_EQ(find_metric(found, "velocity_peak_error").unit, "m/s");
}

TEST(PeakMetrics, AreNoneWhereNobodyAsks) {
  EXPECT_EQ(read("peak_error = false").families.size(), usual_metrics().size());
  EXPECT_EQ(read("").families.size(), usual_metrics().size());
  EXPECT_THAT(error_message([] { read("peak_errors = true"); }), HasSubstr("did you mean \"peak_error\""));
}

TEST(PeakMetrics, ComeThroughAComparison) {
  Ensemble ensemble;
  ensemble.add("plain", testing::RadarFilter{}.tracker());
  TrackerSet set(std::move(ensemble));
  set.show_member("plain");
  ComparisonOptions options;
  options.runs = 3;
  options.scoring = read("peak_error = true");
  const LineScenario scenario = testing::radar_family(20);
  const Comparison comparison = compare(set, {{"family", &scenario}}, options);
  EXPECT_GT(find_metric(comparison.trackers[0].metrics, "position_peak_error").value,
            comparison.trackers[0].quantity("position_m")->rmse);
  EXPECT_THAT(comparison_json(comparison), HasSubstr("\"velocity_peak_error\""));
  EXPECT_THAT(comparison_table(comparison), HasSubstr("position peak error m"));
}

}  // namespace
}  // namespace truebearing::peak_metrics_test
