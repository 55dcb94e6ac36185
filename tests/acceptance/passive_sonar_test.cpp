// SPDX-License-Identifier: Apache-2.0
// Passive sonar held to the bars of its problem, on fewer runs than they are meant for: two standard errors are allowed
// on top.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tests/support/comparisons.hpp"

namespace truebearing::passive_sonar_test {
namespace {

using testing::expect_better;
using testing::expect_no_worse;
using testing::load_study;
using testing::metric;
using testing::run_members;

constexpr double kBatch_s = 1050.0;

Metric position_rmse(const std::string& study, const std::string& tracker, std::size_t runs, double time_s = kBatch_s) {
  return metric(run_members(load_study(study), {tracker}, runs), tracker, "position_rmse", time_s);
}

TEST(PassiveSonar, BatchReachesItsBarWhereTheSourceKeepsItsFrequency) {
  const Comparison comparison = run_members(load_study("passive_sonar_a"), {"batch"}, 150);
  const Metric position = metric(comparison, "batch", "position_rmse", kBatch_s);
  EXPECT_LT(position.value, 180.0 + 2.0 * position.se);
  const Metric nees = metric(comparison, "batch", "nees", kBatch_s);
  EXPECT_NEAR(nees.value, 5.0, 3.0 * nees.se);
  EXPECT_LT(metric(comparison, "batch", "frequency_rmse", kBatch_s).value, 0.01);
}

TEST(PassiveSonar, TheSwitchToBearingsSavesTheBatchFromAJump) {
  const Metric with = position_rmse("passive_sonar_b", "batch", 150);
  EXPECT_LT(with.value, 560.0 + 2.0 * with.se);
  EXPECT_GT(position_rmse("passive_sonar_c", "batch", 40).value, 5000.0);
}

TEST(PassiveSonar, LevelsOfTheSourceCostNothing) {
  const Comparison comparison = run_members(load_study("passive_sonar_d"), {"batch", "segments"}, 150);
  const Metric position = metric(comparison, "batch", "position_rmse", kBatch_s);
  EXPECT_LT(position.value, 180.0 + 2.0 * position.se);
  EXPECT_GT(metric(comparison, "segments", "position_rmse", kBatch_s).value, position.value);
}

TEST(PassiveSonar, TheScanFindsJumpsThatTwoFrequenciesDoNotTell) {
  const Comparison found = run_members(load_study("passive_sonar_small_jump"), {"batch"}, 150);
  const Metric share = metric(found, "batch", "source_change_share", 0.0);
  EXPECT_GT(share.value, 0.95 - 2.0 * share.se);
  const Comparison quiet = run_members(load_study("passive_sonar_a"), {"batch"}, 250);
  EXPECT_LE(metric(quiet, "batch", "source_change_share", 0.0).value, 2.0 / 250.0);
}

TEST(PassiveSonar, TheTunedMultipleModelFollowsTheTurn) {
  const Comparison comparison = run_members(load_study("passive_sonar_turn"), {"imm", "ekf"}, 150);
  const Metric before = metric(comparison, "imm", "position_rmse", 1470.0);
  EXPECT_LT(before.value, 75.0 + 2.0 * before.se);
  const Metric after = metric(comparison, "imm", "position_rmse", 2093.0);
  EXPECT_LT(after.value, 90.0 + 2.0 * after.se);
  EXPECT_GT(metric(comparison, "ekf", "position_rmse", 2093.0).value, 500.0);
}

TEST(PassiveSonar, SigmaPointsAndABankFindTheTargetFromAGuess) {
  const Comparison comparison = run_members(load_study("passive_sonar_a"), {"ekf", "ukf", "bank"}, 150);
  for (const char* name : {"ukf", "bank"}) {
    const Metric position = metric(comparison, name, "position_rmse", kBatch_s);
    EXPECT_LT(position.value, 165.0 + 2.0 * position.se) << name;
  }
}

// 700 of the 3000 runs that the bars are meant for.
TEST(PassiveSonar, CorrectionsOfTheTurnReachTheirBars) {
  const Study study = load_study("passive_sonar_turns");
  TrackerSet trackers(study.make_ensemble({"imm2", "ct9"}));
  for (const char* base : {"imm2", "ct9"}) trackers.show_member(base);
  for (const char* name : {"imm2_nfnn", "ct9_nfnn"})
    trackers.show_correction(name, study.load_model(name), study.tracker(name).correction->bounds);
  ComparisonOptions options = study.comparison_options();
  options.runs = 700;
  options.seed = 20;
  options.pairs = {{"imm2_nfnn", "imm2"}, {"ct9_nfnn", "ct9"}};
  const Comparison comparison = compare(trackers, study.evaluation_scenarios(), options);
  const auto velocity = [&](const char* tracker, const std::string& phase) {
    const auto& summary = *comparison.tracker(tracker);
    const auto place = std::find(comparison.phases.begin(), comparison.phases.end(), phase) - comparison.phases.begin();
    for (const QuantitySummary& quantity : summary.quantities)
      if (quantity.name == "velocity_mps") return quantity.phases[static_cast<std::size_t>(place)];
    ADD_FAILURE() << tracker << " has no velocity";
    return QuantitySummary::Phase{};
  };
  const auto expect_below = [&](const char* tracker, const char* phase, double bar) {
    const auto rmse = velocity(tracker, phase);
    EXPECT_LT(rmse.rmse, bar + 2.0 * rmse.rmse_se) << tracker << ' ' << phase;
  };
  expect_below("imm2_nfnn", "turn", 0.87);
  expect_below("imm2_nfnn", "after_200", 0.60);
  expect_below("imm2_nfnn", "quiet", 1.15 * velocity("imm2", "quiet").rmse);
  expect_below("ct9_nfnn", "turn", 0.74);
  expect_below("ct9_nfnn", "after_200", 0.49);
  for (const char* name : {"imm2_nfnn", "ct9_nfnn"}) EXPECT_GT(comparison.tracker(name)->coverage95, 0.92) << name;
  for (const char* base : {"imm2", "ct9"}) {
    expect_no_worse(comparison, std::string(base) + "_nfnn", base, "position_m");
    expect_better(comparison, std::string(base) + "_nfnn", base, "velocity_mps");
  }
}

// 40 of the 1000 runs that its study has.
TEST(PassiveSonar, TheLimitOfTheTurnIsBelowItsTrackersAndKnowsHowWellItKnows) {
  const Study study = load_study("passive_sonar_turns_limit");
  TrackerSet trackers(study.make_ensemble({"ct9", "limit"}));
  for (const char* name : {"ct9", "limit"}) trackers.show_member(name);
  ComparisonOptions options = study.comparison_options();
  options.runs = 40;
  options.seed = 20;
  options.pairs = {{"limit", "ct9"}};
  const Comparison comparison = compare(trackers, study.evaluation_scenarios(), options);
  expect_better(comparison, "limit", "ct9", "velocity_mps");
  EXPECT_GT(comparison.tracker("limit")->coverage95, 0.92);
  EXPECT_LT(comparison.tracker("limit")->coverage95, 0.98);
}

}  // namespace
}  // namespace truebearing::passive_sonar_test
