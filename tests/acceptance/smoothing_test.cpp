// SPDX-License-Identifier: Apache-2.0
// What smoothers are held to. Fewer runs than the bars are meant for: two standard errors are allowed on top.
#include <gtest/gtest.h>

#include "tests/support/comparisons.hpp"

namespace truebearing::smoothing_test {
namespace {

using testing::load_study;

Comparison run(const std::string& name, std::size_t runs) {
  const Study study = load_study(name);
  ComparisonOptions options = study.comparison_options();
  options.runs = runs;
  options.seed = 20;
  return compare(study.make_tracker_set(), study.evaluation_scenarios(), options);
}

TEST(Smoothing, OfAMultipleModelIsAQuarterBetterThanTheFilter) {
  const Comparison comparison = run("manoeuvre_2d_smoothed", 30);
  const PairedDifference found = testing::difference(comparison, "imm6_smoothed", "imm6", "position_m");
  EXPECT_LT(found.mean + 2.0 * found.se, -0.25 * comparison.tracker("imm6")->quantity("position_m")->rmse);
  for (const char* quantity : {"position_m", "velocity_mps"}) {
    testing::expect_better(comparison, "tuned_smoothed", "tuned", quantity);
    testing::expect_better(comparison, "imm6_lag_10", "imm6", quantity);
  }
}

TEST(Smoothing, OfTheSingerFilterIsThePublishedOne) {
  const Comparison comparison = run("benchmark_zhenbiny_smoothed", 100);
  const QuantitySummary& position = *comparison.tracker("singer_smoothed")->quantity("position_m");
  EXPECT_LT(position.rmse, 53.0 + 2.0 * position.rmse_se);
}

TEST(Smoothing, TeachesAtLeastHalfOfWhatTheTruthDoes) {
  const Comparison comparison = run("manoeuvre_2d_no_truth", 100);
  const auto rmse = [&](const char* tracker, const char* quantity) {
    return comparison.tracker(tracker)->quantity(quantity)->rmse;
  };
  for (const char* quantity : {"position_m", "velocity_mps"}) {
    for (const char* blind : {"nfnn_no_truth", "nfnn_guess"})
      EXPECT_GT(rmse("tuned", quantity) - rmse(blind, quantity),
                0.5 * (rmse("tuned", quantity) - rmse("nfnn", quantity)))
          << blind << ", " << quantity;
    EXPECT_GT(rmse("imm6", quantity) - rmse("imm6_nfnn_no_truth", quantity),
              0.5 * (rmse("imm6", quantity) - rmse("imm6_nfnn", quantity)))
        << quantity;
  }
}

}  // namespace
}  // namespace truebearing::smoothing_test
