// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/summary.hpp"

#include <gtest/gtest.h>

#include "tests/support/line_trackers.hpp"
#include "tests/support/metric_runs.hpp"
#include "truebearing/core/chi_square.hpp"
#include "truebearing/core/constants.hpp"

namespace truebearing::summary_test {
namespace {

using testing::pointers;

const Scorer kScorer(line_space(), line_space());

RunScore run(std::vector<double> position, std::vector<double> velocity, std::vector<double> nees) {
  RunScore score;
  score.error = {std::move(position), std::move(velocity)};
  score.quantity_nees = {nees, nees};
  score.nees = std::move(nees);
  return score;
}

// Runs of different lengths of scored steps, a NaN here and there.
std::vector<RunScore> random_runs(std::size_t count) {
  std::vector<RunScore> runs;
  RandomStream random({.seed = 8}, StreamId::test);
  for (std::size_t r = 0; r < count; ++r) {
    RunScore score;
    kScorer.prepare(score, 20);
    const double size = std::exp(random.normal());
    for (std::size_t step = 3; step < 20; ++step) {
      if (random.uniform() < 0.1) continue;
      score.error[0][step] = size * std::abs(random.normal());
      score.error[1][step] = 0.1 * size * std::abs(random.normal());
      score.nees[step] = -2.0 * std::log(1.0 - random.uniform());  // chi-square with 2 degrees of freedom
    }
    runs.push_back(score);
  }
  return runs;
}

double pooled_rmse(const std::vector<RunScore>& runs, std::size_t quantity, std::size_t left_out) {
  double sum = 0.0, count = 0.0;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    if (r == left_out) continue;
    for (const double error : runs[r].error[quantity])
      if (!std::isnan(error)) sum += error * error, count += 1.0;
  }
  return std::sqrt(sum / count);
}

TEST(Summary, FiguresByHand) {
  const std::vector<RunScore> runs{run({3.0, 4.0}, {1.0, 1.0}, {1.0, 7.0}), run({0.0, kNaN}, {1.0, kNaN}, {4.0, kNaN})};
  const TrackerSummary summary = summarise("t", kScorer, pointers(runs), {});
  EXPECT_EQ(summary.name, "t");
  EXPECT_EQ(summary.dimension, 2);
  EXPECT_DOUBLE_EQ(summary.quantity("position_m")->rmse, std::sqrt(25.0 / 3.0)) << "over runs and scored steps";
  EXPECT_DOUBLE_EQ(summary.quantity("position_m")->median, 3.0);
  EXPECT_DOUBLE_EQ(summary.quantity("velocity_mps")->rmse, 1.0);
  EXPECT_DOUBLE_EQ(summary.nees, 4.0);
  EXPECT_DOUBLE_EQ(summary.coverage95, 2.0 / 3.0) << "7 is beyond 5.99";
  EXPECT_EQ(summary.scored_steps, 3);
  EXPECT_DOUBLE_EQ(summary.quantity("position_m")->series[0], std::sqrt(4.5));
  EXPECT_DOUBLE_EQ(summary.quantity("position_m")->series[1], 4.0);
  EXPECT_EQ(summary.quantity("height_m"), nullptr);
}

TEST(Summary, PhasesAreScoredApart) {
  std::vector<RunScore> runs{run({3.0, 4.0, kNaN}, {1.0, 1.0, kNaN}, {1.0, 7.0, kNaN}),
                             run({1.0, 2.0, 2.0}, {1.0, 3.0, 5.0}, {4.0, 1.0, 9.0})};
  runs[0].phase = {0, 1, 1};
  runs[1].phase = {0, 1, 0};
  const TrackerSummary summary = summarise("t", kScorer, pointers(runs), {});
  const std::vector<QuantitySummary::Phase>& position = summary.quantity("position_m")->phases;
  ASSERT_EQ(position.size(), 2u);
  EXPECT_DOUBLE_EQ(position[0].rmse, std::sqrt((9.0 + 1.0 + 4.0) / 3.0));
  EXPECT_DOUBLE_EQ(position[1].rmse, std::sqrt((16.0 + 4.0) / 2.0));
  EXPECT_DOUBLE_EQ(summary.quantity("position_m")->coverage95, 2.0 / 5.0) << "7, 4 and 9 are beyond 3.84";
}

TEST(Summary, StepsOfNoPhaseAreInNone) {
  std::vector<RunScore> runs{run({30.0, 40.0, 3.0}, {1.0, 1.0, 1.0}, {1.0, 1.0, 1.0})};
  runs[0].phase = {-1, -1, 0};
  const TrackerSummary summary = summarise("t", kScorer, pointers(runs), {});
  ASSERT_EQ(summary.quantity("position_m")->phases.size(), 1u);
  EXPECT_DOUBLE_EQ(summary.quantity("position_m")->phases[0].rmse, 3.0);
}

TEST(Summary, MedianOfAnEvenNumberIsTheMiddle) {
  const std::vector<RunScore> runs{run({9.0, 1.0}, {0.0, 0.0}, {1.0, 1.0}), run({2.0, 4.0}, {0.0, 0.0}, {1.0, 1.0})};
  EXPECT_DOUBLE_EQ(summarise("t", kScorer, pointers(runs), {}).quantity("position_m")->median, 3.0);
}

TEST(Summary, StandardErrorIsTheJackknife) {
  const std::vector<RunScore> runs = random_runs(40);
  const TrackerSummary summary = summarise("t", kScorer, pointers(runs), {});
  for (std::size_t quantity = 0; quantity < 2; ++quantity) {
    std::vector<double> left_out;
    for (std::size_t r = 0; r < runs.size(); ++r) left_out.push_back(pooled_rmse(runs, quantity, r));
    double mean = 0.0, squares = 0.0;
    for (const double value : left_out) mean += value / 40.0;
    for (const double value : left_out) squares += (value - mean) * (value - mean);
    EXPECT_NEAR(summary.quantities[quantity].rmse, pooled_rmse(runs, quantity, 1000), 1e-12);
    EXPECT_NEAR(summary.quantities[quantity].rmse_se, std::sqrt(39.0 / 40.0 * squares), 1e-9);
  }
}

TEST(Summary, OfASingleRunHasNoStandardError) {
  const std::vector<RunScore> runs = random_runs(1);
  EXPECT_TRUE(std::isnan(summarise("t", kScorer, pointers(runs), {}).quantities[0].rmse_se));
}

TEST(Summary, LossRateIsTheShareOfRunsThatEndBeyondTheThreshold) {
  const std::vector<RunScore> runs{run({900.0, 9.0}, {0.0, 0.0}, {1.0, 1.0}), run({1.0, 11.0}, {0.0, 0.0}, {1.0, 1.0}),
                                   run({1.0, 9.0}, {0.0, 6.0}, {1.0, 1.0}), run({12.0, kNaN}, {0.0, kNaN}, {1.0, kNaN}),
                                   run({kNaN, kNaN}, {kNaN, kNaN}, {kNaN, kNaN})};
  const ScoringRule rule{.from_step = 1, .loss_thresholds = {{"position_m", 10.0}, {"velocity_mps", 5.0}}};
  EXPECT_DOUBLE_EQ(summarise("t", kScorer, pointers(runs), rule).loss_rate, 0.8)
      << "all but the first; a run without a record is lost";
  EXPECT_DOUBLE_EQ(summarise("t", kScorer, pointers(runs), {}).loss_rate, 0.0) << "nobody said what lost is";
}

TEST(Summary, NothingScoredIsNaNNotZero) {
  const std::vector<RunScore> runs{run({kNaN}, {kNaN}, {kNaN})};
  const TrackerSummary summary = summarise("t", kScorer, pointers(runs), {});
  EXPECT_TRUE(std::isnan(summary.quantities[0].rmse));
  EXPECT_TRUE(std::isnan(summary.quantities[0].median));
  EXPECT_TRUE(std::isnan(summary.nees));
  EXPECT_TRUE(std::isnan(summary.coverage95));
  EXPECT_EQ(summary.scored_steps, 0);
}

TEST(Summary, OrderOfTheRunsDoesNotMatterToTheMedianNorMuchToTheRest) {
  std::vector<RunScore> runs = random_runs(40);
  const TrackerSummary forward = summarise("t", kScorer, pointers(runs), {});
  std::reverse(runs.begin(), runs.end());
  const TrackerSummary backward = summarise("t", kScorer, pointers(runs), {});
  EXPECT_EQ(forward.quantities[0].median, backward.quantities[0].median);
  EXPECT_EQ(forward.coverage95, backward.coverage95);
  EXPECT_NEAR(forward.quantities[0].rmse, backward.quantities[0].rmse, 1e-12);
}

TEST(Summary, TargetsShareTheStepsOfTheSeriesAndStayInTheirRun) {
  std::vector<RunScore> runs{run({3.0, 4.0, 1.0, kNaN}, {1, 1, 1, 1}, {1, 1, 1, 1}),
                             run({0.0, 2.0, 2.0, 2.0}, {1, 1, 1, 1}, {1, 1, 1, 1})};
  for (RunScore& score : runs) {
    score.targets = 2;
    score.phase = {0, 1, 1, 0};
  }
  const TrackerSummary summary = summarise("t", kScorer, pointers(runs), {});
  const QuantitySummary& position = *summary.quantity("position_m");
  ASSERT_EQ(position.series.size(), 2u);
  EXPECT_DOUBLE_EQ(position.series[0], std::sqrt((9.0 + 1.0 + 0.0 + 4.0) / 4.0));
  EXPECT_DOUBLE_EQ(position.series[1], std::sqrt((16.0 + 4.0 + 4.0) / 3.0));
  EXPECT_DOUBLE_EQ(position.rmse, std::sqrt(38.0 / 7.0));
  const double without_first = std::sqrt(12.0 / 4.0), without_second = std::sqrt(26.0 / 3.0);
  EXPECT_NEAR(position.rmse_se, 0.5 * std::abs(without_first - without_second), 1e-12) << "of two runs, not four";
  EXPECT_DOUBLE_EQ(position.phases[1].rmse, std::sqrt((16.0 + 1.0 + 4.0 + 4.0) / 4.0));
  EXPECT_EQ(summary.scored_steps, 7);
}

TEST(Summary, ARunIsLostWithAnyTarget) {
  std::vector<RunScore> runs{run({1.0, 12.0, 1.0, 1.0}, {0, 0, 0, 0}, {1, 1, 1, 1}),
                             run({12.0, 1.0, 12.0, 1.0}, {0, 0, 0, 0}, {1, 1, 1, 1}),
                             run({1.0, 1.0, kNaN, kNaN}, {0, 0, 0, 0}, {1, 1, 1, 1})};
  for (RunScore& score : runs) score.targets = 2;
  const ScoringRule rule{.from_step = 1, .loss_thresholds = {{"position_m", 10.0}}};
  EXPECT_DOUBLE_EQ(summarise("t", kScorer, pointers(runs), rule).loss_rate, 2.0 / 3.0) << "all but the second";
}

TEST(PairedDifference, IsOverRunsOfTheRunsOwnRmse) {
  const std::vector<RunScore> a{run({3.0, 4.0}, {0.0, 0.0}, {1.0, 1.0}), run({1.0, 1.0}, {0.0, 0.0}, {1.0, 1.0}),
                                run({6.0, kNaN}, {0.0, kNaN}, {1.0, 1.0})};
  const std::vector<RunScore> b{run({0.0, 1.0}, {0.0, 0.0}, {1.0, 1.0}), run({2.0, 2.0}, {0.0, 0.0}, {1.0, 1.0}),
                                run({kNaN, kNaN}, {kNaN, kNaN}, {1.0, 1.0})};
  const std::vector<PairedDifference> differences = paired_difference(kScorer, pointers(a), kScorer, pointers(b));
  ASSERT_EQ(differences.size(), 2u);
  EXPECT_EQ(differences[0].quantity, "position_m");
  const double first = std::sqrt(12.5) - std::sqrt(0.5), second = -1.0;  // the third run has no b
  EXPECT_NEAR(differences[0].mean, 0.5 * (first + second), 1e-12);
  EXPECT_NEAR(differences[0].se, 0.5 * std::abs(first - second), 1e-12);
}

TEST(PairedDifference, OnlyOfQuantitiesThatBothHave) {
  const Scorer raw(line_space(), state_space_of_components({"position_m"}));
  RunScore positions;
  positions.error = {{1.0}};
  positions.nees = {1.0};
  const std::vector<RunScore> a{positions}, b{run({3.0}, {1.0}, {1.0})};
  const auto differences = paired_difference(raw, pointers(a), kScorer, pointers(b));
  ASSERT_EQ(differences.size(), 1u);
  EXPECT_EQ(differences[0].mean, -2.0);
  EXPECT_TRUE(std::isnan(differences[0].se));
}

}  // namespace
}  // namespace truebearing::summary_test
