// SPDX-License-Identifier: Apache-2.0
// The published tables on the Lorenz attractor, on the committed models. Fewer runs than the figures of docs/results.md:
// two standard errors are allowed on top.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/comparisons.hpp"

namespace truebearing::lorenz_acceptance_test {
namespace {

using testing::load_study;

// Of the mean over components, steps and runs of the squared error.
Metric decibels(const Comparison& comparison, const std::string& tracker) {
  return testing::metric(comparison, tracker, "mse_db", 0.0);
}

void expect_below(const Comparison& comparison, const std::string& tracker, double bar) {
  const Metric found = decibels(comparison, tracker);
  EXPECT_LT(found.value, bar + 2.0 * found.se) << tracker;
}

Comparison run(const std::string& name, std::size_t runs, const std::vector<std::string>& sets) {
  const Study study = load_study(name);
  std::vector<NamedScenario> scenarios;
  for (const NamedScenario& scenario : study.evaluation_scenarios())
    if (std::find(sets.begin(), sets.end(), scenario.name) != sets.end()) scenarios.push_back(scenario);
  EXPECT_EQ(scenarios.size(), sets.size());
  ComparisonOptions options = study.comparison_options();
  options.runs = runs;
  options.seed = 20;
  return compare(study.make_tracker_set(), scenarios, options);
}

TEST(Lorenz, MismatchIsReproducedAndLearned) {
  const Comparison published = run("lorenz_mismatch", 2, {"published"});
  const Metric ekf = decibels(published, "ekf");
  EXPECT_NEAR(ekf.value, -6.32, 0.15 + 2.0 * ekf.se);
  const Comparison fresh = run("lorenz_mismatch", 2, {"fresh"});
  for (const Comparison& comparison : {published, fresh}) {
    expect_below(comparison, "rk4_tuned", -14.3);
    expect_below(comparison, "learned", -14.0);
    EXPECT_LT(decibels(comparison, "gru").value, -12.0);
    EXPECT_LT(decibels(comparison, "learned").value, decibels(comparison, "tuned").value - 2.0);
  }
}

TEST(Lorenz, RotationIsFittedFromPairs) {
  const Comparison comparison = run("lorenz_rotated", 8, {"long"});
  expect_below(comparison, "fitted", -40.0);
  EXPECT_GT(decibels(comparison, "ekf").value, -20.0);
  EXPECT_NEAR(decibels(comparison, "fitted").value, decibels(comparison, "aligned").value, 0.1);
}

// Below every printed row at all four levels of noise: RMSE per component.
TEST(Lorenz, PredictionsFromTheUnstablePointAreBelowThePrintedOnes) {
  const std::vector<std::pair<std::string, double>> best{
      {"r2_1", 0.399}, {"r2_10", 0.823}, {"r2_100", 2.016}, {"r2_1000", 5.281}};
  for (const auto& [set, rmse] : best) expect_below(run("lorenz_filternet", 40, {set}), "gru", 20.0 * std::log10(rmse));
}

}  // namespace
}  // namespace truebearing::lorenz_acceptance_test
