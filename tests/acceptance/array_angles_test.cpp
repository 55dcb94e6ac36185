// SPDX-License-Identifier: Apache-2.0
// Several targets at a line array held to the bars of their problem, on fewer runs than they are meant for: two
// standard errors are allowed on top.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "tests/support/comparisons.hpp"

namespace truebearing::array_angles_test {
namespace {

using testing::expect_better;
using testing::load_study;
using testing::metric;
using testing::run_members;

double value(const Comparison& comparison, const std::string& tracker, const std::string& name) {
  return metric(comparison, tracker, name, 0.0).value;
}

void expect_below(const Comparison& comparison, const std::string& tracker, const std::string& name, double bar) {
  const Metric found = metric(comparison, tracker, name, 0.0);
  EXPECT_LT(found.value, bar + 2.0 * found.se) << tracker << ' ' << name;
}

// A share that is to stay below a bar, with the standard error that the bar itself has on so many runs.
void expect_share_below(const Comparison& comparison, const std::string& tracker, double bar) {
  const double se = std::sqrt(bar * (1.0 - bar) / static_cast<double>(comparison.runs));
  EXPECT_LT(value(comparison, tracker, "bad_share"), bar + 2.0 * se) << tracker;
}

TEST(ArrayAngles, ThePapersTrackerIsReproduced) {
  const struct {
    const char* study;
    double mse;
  } cases[] = {{"array_a_0db", 0.27}, {"array_a_10db", 0.136}};
  for (const auto& expected : cases) {
    const Comparison comparison = run_members(load_study(expected.study), {"paper", "ryu"}, 60);
    const Metric clean = metric(comparison, "paper", "clean_mse", 0.0);
    EXPECT_NEAR(clean.value, expected.mse, 0.05 * expected.mse + 2.0 * clean.se) << expected.study;
    expect_share_below(comparison, "paper", 0.05);
    EXPECT_NEAR(value(comparison, "ryu", "all_mse"), value(comparison, "paper", "all_mse"), 1e-6) << expected.study;
  }
}

TEST(ArrayAngles, ThePapersStructureIsImproved) {
  const Comparison weak = run_members(load_study("array_a_0db"), {"improved"}, 60);
  expect_below(weak, "improved", "clean_mse", 0.19);
  expect_below(weak, "improved", "all_mse", 0.25);
  const Comparison strong = run_members(load_study("array_a_10db"), {"improved", "lag_fixed"}, 60);
  expect_below(strong, "improved", "clean_mse", 0.055);
  expect_below(strong, "lag_fixed", "clean_mse", 0.055);
  EXPECT_EQ(value(strong, "improved", "swap_runs"), 0.0);
}

TEST(ArrayAngles, TheJointFilterReachesItsBars) {
  const struct {
    const char* study;
    double mse;
  } cases[] = {{"array_a_0db", 0.036}, {"array_a_5db", 0.0145}, {"array_a_10db", 0.0062}};
  for (const auto& expected : cases) {
    const Comparison comparison = run_members(load_study(expected.study), {"joint"}, 60);
    expect_below(comparison, "joint", "clean_mse", expected.mse);
    expect_share_below(comparison, "joint", 0.01);
  }
  expect_share_below(run_members(load_study("array_c_0db"), {"joint"}, 60), "joint", 0.01);
}

TEST(ArrayAngles, TheJointFilterKeepsItsTargetsOnRandomCourses) {
  expect_share_below(run_members(load_study("array_random_0db"), {"joint"}, 200), "joint", 0.06);
  expect_share_below(run_members(load_study("array_random_10db"), {"joint"}, 300), "joint", 0.02);
  expect_share_below(run_members(load_study("array_random_moving_0db"), {"joint"}, 150), "joint", 0.085);
  const Comparison paper = run_members(load_study("array_random_10db"), {"paper"}, 40);
  EXPECT_GT(value(paper, "paper", "bad_share"), 0.3);
}

TEST(ArrayAngles, CorrectionsOfAngleAndRateReachTheirBars) {
  const auto corrected = [](const char* name, std::size_t runs) {
    const Study study = load_study(name);
    TrackerSet trackers(study.make_ensemble({"joint", "lag_fixed"}));
    for (const char* base : {"joint", "lag_fixed"}) trackers.show_member(base);
    for (const char* tracker : {"joint_nfnn", "joint_gru", "lag_fixed_nfnn"})
      trackers.show_correction(tracker, study.load_model(tracker), study.tracker(tracker).correction->bounds);
    ComparisonOptions options = study.comparison_options();
    options.runs = runs;
    options.seed = 20;
    options.pairs.emplace_back("joint_gru", "joint_nfnn");
    return compare(trackers, study.evaluation_scenarios(), options);
  };
  const struct {
    const char* study;
    double nfnn, gru, gru_nees;
  } of_the_paper[] = {{"array_a_0db", 0.029, 0.0225, 2.3}, {"array_a_10db", 0.0042, 0.0034, 2.5}};
  for (const auto& [study, nfnn, gru, gru_nees] : of_the_paper) {
    SCOPED_TRACE(study);
    const Comparison comparison = corrected(study, 60);
    expect_below(comparison, "joint_nfnn", "clean_mse", nfnn);
    expect_below(comparison, "joint_gru", "clean_mse", gru);
    EXPECT_GT(comparison.tracker("joint_gru")->nees, 1.7);
    EXPECT_LT(comparison.tracker("joint_gru")->nees, gru_nees);
  }
  for (const char* study : {"array_random_0db", "array_random_10db"}) {
    const Comparison comparison = corrected(study, 120);
    for (const char* quantity : {"angle_deg2_clean", "rate_degps2_clean"}) {
      SCOPED_TRACE(study);
      expect_better(comparison, "joint_nfnn", "joint", quantity);
      expect_better(comparison, "joint_gru", "joint_nfnn", quantity);
      expect_better(comparison, "lag_fixed_nfnn", "lag_fixed", quantity);
    }
    for (const char* tracker : {"joint_nfnn", "joint_gru"})
      EXPECT_GT(comparison.tracker(tracker)->coverage95, 0.9) << study << ' ' << tracker;
  }
}

}  // namespace
}  // namespace truebearing::array_angles_test
