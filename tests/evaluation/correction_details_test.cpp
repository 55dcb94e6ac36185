// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/correction_details.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <numeric>

#include "tests/evaluation/corrected_set.hpp"
#include "tests/support/line_trackers.hpp"
#include "truebearing/evaluation/comparison.hpp"
#include "truebearing/evaluation/report.hpp"

namespace truebearing::correction_details_test {
namespace {

using nlohmann::json;

constexpr int kSteps = 30, kRuns = 6;

Comparison compared(int threads, bool details, bool two_sets = false) {
  const LineScenario scenario = testing::radar_family(kSteps), longer = testing::radar_family(kSteps + 10);
  std::vector<NamedScenario> scenarios{{"family", &scenario}};
  if (two_sets) scenarios.push_back({"longer", &longer});
  ComparisonOptions options;
  options.runs = kRuns;
  options.threads = threads;
  options.scoring.from_step = 3;
  options.details = details;
  return compare(testing::corrected_set({"tuned"}), scenarios, options);
}

double sum_of(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values)
    if (!std::isnan(value)) sum += value;
  return sum;
}

TEST(CorrectionDetails, AgreeWithTheFiguresOfTheComparison) {
  const Comparison comparison = compared(1, true);
  ASSERT_EQ(comparison.corrections.size(), 2u);
  EXPECT_FALSE(comparison.corrections[0]) << "tuned is no correction";
  ASSERT_TRUE(comparison.corrections[1]);
  const CorrectionDetails& details = *comparison.corrections[1];
  const TrackerSummary& summary = *comparison.tracker("nfnn");
  EXPECT_EQ(details.steps, static_cast<double>(summary.corrected_steps));
  ASSERT_EQ(details.gate.size(), static_cast<std::size_t>(kSteps));
  EXPECT_TRUE(std::isnan(details.gate[1])) << "not scored";
  constexpr double kScored = kSteps - 2;  // as many runs in each of them
  EXPECT_NEAR(sum_of(details.gate) / kScored, summary.mean_gate, 1e-12);
  EXPECT_NEAR(sum_of(details.limited) / kScored, summary.limited_share, 1e-12);
  EXPECT_GT(summary.limited_share, 0.0) << "kappa must have something to cut";
  for (std::size_t step = 2; step < details.gate.size(); ++step)
    EXPECT_LE(details.moved_sigmas[step], details.wanted_sigmas[step]) << step;
}

TEST(CorrectionDetails, RulesShareEveryStepAndBinsHoldEveryValue) {
  const Comparison comparison = compared(1, true);
  const CorrectionDetails& details = *comparison.corrections[1];
  ASSERT_EQ(details.rules.size(), 6u);
  double fired = 0.0, strongest = 0.0;
  for (const CorrectionDetails::Rule& rule : details.rules) {
    fired += rule.fired;
    strongest += rule.strongest;
  }
  EXPECT_NEAR(fired, 1.0, 1e-12);
  EXPECT_NEAR(strongest, 1.0, 1e-12);
  ASSERT_EQ(details.features.size(), 4u);
  for (const CorrectionDetails::Feature& feature : details.features)
    EXPECT_EQ(std::accumulate(feature.counted.begin(), feature.counted.end(), 0.0), details.asked);
  // ln k of the steps 3 to 30, of which 8 and later lie above 2.
  EXPECT_NEAR(details.features[0].least, std::log(3.0), 1e-12);
  EXPECT_NEAR(details.features[0].greatest, std::log(30.0), 1e-12);
  EXPECT_NEAR(details.features[0].outside, 23.0 / 28.0, 1e-12);
}

TEST(CorrectionDetails, AreTheSameForAnyNumberOfThreadsAndChangeNoFigure) {
  for (const bool two_sets : {false, true}) {
    const std::string one = comparison_json(compared(1, true, two_sets));
    EXPECT_EQ(comparison_json(compared(3, true, two_sets)), one);
    json with = json::parse(one), without = json::parse(comparison_json(compared(2, false, two_sets)));
    EXPECT_TRUE(with["trackers"]["nfnn"]["details"]["correction"]["rules"].is_array());
    EXPECT_EQ(with.contains("sets"), two_sets);
    for (auto& [name, tracker] : with["trackers"].items()) tracker.erase("details");
    if (two_sets)
      for (auto& [name, set] : with["sets"].items()) {
        EXPECT_EQ(set["trackers"]["nfnn"]["details"]["correction"]["by_step"]["gate"].size(),
                  name == "longer" ? kSteps + 10u : kSteps);
        set["trackers"]["nfnn"].erase("details");
      }
    EXPECT_EQ(with, without);
  }
}

}  // namespace
}  // namespace truebearing::correction_details_test
