// SPDX-License-Identifier: Apache-2.0
// The 1-D radar studies on their committed models, held to the bars of the problem. Fewer runs than the bars are meant
// for: two standard errors are allowed on top.
#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "tests/support/comparisons.hpp"
#include "tests/support/real_data.hpp"
#include "truebearing/recording/recording_csv.hpp"
#include "truebearing/simulation/recorded_scenario.hpp"

namespace truebearing::radar_1d_test {
namespace {

using testing::difference;
using testing::expect_no_worse;
using testing::load_study;

Comparison run(const Study& study, std::size_t runs, std::uint64_t seed = 20) {
  ComparisonOptions options = study.comparison_options();
  options.runs = runs;
  options.seed = seed;
  return compare(study.make_tracker_set(), study.evaluation_scenarios(), options);
}

const QuantitySummary& figure(const Comparison& comparison, const std::string& tracker, const std::string& quantity) {
  return *comparison.tracker(tracker)->quantity(quantity);
}

// The RMSE of a over that of b: below `bar` up to two of a's standard errors.
void expect_ratio_below(const Comparison& comparison, const std::string& a, const std::string& b,
                        const std::string& quantity, double bar) {
  const QuantitySummary &of_a = figure(comparison, a, quantity), &of_b = figure(comparison, b, quantity);
  EXPECT_LT(of_a.rmse / of_b.rmse, bar + 2.0 * of_a.rmse_se / of_b.rmse) << a << " / " << b << ", " << quantity;
}

TEST(Radar1d, PaperIsReproducedAndBeaten) {
  const Comparison comparison = run(load_study("radar_1d_paper"), 200);
  const QuantitySummary &position = figure(comparison, "plain", "position_m"),
                        &velocity = figure(comparison, "plain", "velocity_mps");
  EXPECT_NEAR(position.rmse, 1343.5, 0.02 * 1343.5 + 2.0 * position.rmse_se);
  EXPECT_NEAR(velocity.rmse, 63.7, 0.02 * 63.7 + 2.0 * velocity.rmse_se);
  EXPECT_LT(figure(comparison, "nfnn_paper", "position_m").rmse, 813.0);
  EXPECT_LT(figure(comparison, "nfnn_paper", "velocity_mps").rmse, 13.0);
  EXPECT_LT(figure(comparison, "nfnn", "position_m").rmse,
            520.0 + 2.0 * figure(comparison, "nfnn", "position_m").rmse_se);
  EXPECT_LT(figure(comparison, "nfnn", "velocity_mps").rmse,
            8.5 + 2.0 * figure(comparison, "nfnn", "velocity_mps").rmse_se);
}

TEST(Radar1d, FamilyIsWithinThreePercentOfTheBoundAndConsistent) {
  const Comparison comparison = run(load_study("radar_1d_family"), 200);
  expect_ratio_below(comparison, "nfnn", "plain", "position_m", 0.505);
  expect_ratio_below(comparison, "nfnn", "plain", "velocity_mps", 0.71);
  const TrackerSummary& nfnn = *comparison.tracker("nfnn");
  EXPECT_GT(nfnn.nees, 1.6);  // the bar of 1.8 less the spread of 200 runs
  EXPECT_LT(nfnn.nees, 2.5);
  EXPECT_GT(nfnn.coverage95, 0.92 - 0.02);
  for (const char* quantity : {"position_m", "velocity_mps"}) {
    EXPECT_LT(difference(comparison, "nfnn", "tuned", quantity).mean, 0.0) << quantity;
    expect_no_worse(comparison, "nfnn", "bayes_bank", quantity, 0.03 * figure(comparison, "bayes_bank", quantity).rmse);
  }
}

TEST(Radar1d, OutsideTheFamilyTheReferenceIsKept) {
  const Comparison comparison = run(load_study("radar_1d_shift"), 100);
  ASSERT_EQ(comparison.sets.size(), 2u);
  for (const auto& [name, set] : comparison.sets)
    for (const char* quantity : {"position_m", "velocity_mps"}) {
      SCOPED_TRACE(name);
      expect_no_worse(set, "nfnn", "tuned", quantity, 0.02 * figure(set, "tuned", quantity).rmse);
    }
}

TEST(Radar1d, RealFlightIsTrackedBetterThanByTheTunedFilter) {
  const std::filesystem::path path = testing::real_data("radar_range_ajaccio.csv");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
  const Study study = load_study("radar_1d_flight");
  const RecordedScenario scenario(read_recording(path));
  ComparisonOptions options = study.comparison_options();
  options.runs = 10;
  const Comparison comparison = compare(study.make_tracker_set(), {{"ajaccio", &scenario}}, options);
  expect_ratio_below(comparison, "nfnn", "tuned", "position_m", 0.97);
  expect_ratio_below(comparison, "nfnn", "tuned", "velocity_mps", 0.95);
  EXPECT_LT(figure(comparison, "nfnn", "position_m").rmse, figure(comparison, "raw", "position_m").rmse);
}

}  // namespace
}  // namespace truebearing::radar_1d_test
