// SPDX-License-Identifier: Apache-2.0
// What range rates tell, and corrections in space: the studies of Doppler radars on their committed parameters and models.
#include <gtest/gtest.h>

#include <string>

#include "tests/support/comparisons.hpp"

namespace truebearing::range_rate_acceptance_test {
namespace {

using testing::expect_better;
using testing::load_study;

Comparison run(const std::string& name, std::size_t runs) {
  const Study study = load_study(name);
  ComparisonOptions options = study.comparison_options();
  options.runs = runs;
  options.seed = 20;
  return compare(study.make_tracker_set(), study.evaluation_scenarios(), options);
}

// The bar is 5 % over the bound; with 300 runs two standard errors are allowed on top.
TEST(RangeRate, StraightOnIsFilteredToTheBound) {
  const Comparison comparison = run("straight_doppler", 300);
  ASSERT_TRUE(comparison.cramer_rao);
  for (const Metric& bound : comparison.cramer_rao->metrics) {
    if (bound.time_s != 60.0 || (bound.name != "position_rmse" && bound.name != "velocity_rmse")) continue;
    for (const char* tracker : {"sequential", "ukf", "ekf_2", "sequential_2"}) {
      const Metric found = testing::metric(comparison, tracker, bound.name, 60.0);
      EXPECT_LT(found.value, 1.05 * bound.value + 2.0 * found.se) << tracker << " " << bound.name;
      EXPECT_GT(found.value, bound.value - 3.0 * found.se) << tracker << " " << bound.name;
    }
    // The partner: at first order alone the extended filter is not.
    EXPECT_GT(testing::metric(comparison, "ekf", bound.name, 60.0).value, 1.15 * bound.value) << bound.name;
    const Metric without = testing::metric(comparison, "without", bound.name, 60.0);
    EXPECT_GT(without.value, 1.2 * bound.value) << bound.name;
  }
  for (const char* tracker : {"ekf_2", "sequential_2"})
    EXPECT_NEAR(comparison.tracker(tracker)->nees, 4.0, 0.45) << tracker;
  EXPECT_GT(comparison.tracker("ekf")->nees, 6.0);
}

TEST(RangeRate, HelpsEveryFilterOfTargetsThatTurn) {
  const Comparison comparison = run("radar_2d_doppler", 100);
  for (const char* quantity : {"position_m", "velocity_mps"}) {
    expect_better(comparison, "sequential", "tuned", quantity);
    expect_better(comparison, "ekf", "tuned", quantity);
    expect_better(comparison, "imm6_rate", "imm6", quantity);
  }
}

TEST(SpaceCorrection, IsBelowTheMultipleModelOfOkfsRadar) {
  const Comparison comparison = run("okf_radar", 200);
  for (const char* quantity : {"position_m", "velocity_mps"})
    for (const char* other : {"imm", "tuned"}) expect_better(comparison, "imm_nfnn", other, quantity);
  EXPECT_NEAR(comparison.tracker("imm_nfnn")->nees, 6.0, 1.0);
}

TEST(SpaceCorrection, IsNoWorseWhereTargetsKeepTheirVelocity) {
  const Comparison comparison = run("okf_radar_const_speed", 200);
  for (const char* other : {"imm", "tuned"}) {
    expect_better(comparison, "imm_nfnn", other, "velocity_mps");
    testing::expect_no_worse(comparison, "imm_nfnn", other, "position_m");
  }
  EXPECT_NEAR(comparison.tracker("imm_nfnn")->nees, 6.0, 1.0);
}

// Of angles alone: what is believed of the range decides.
TEST(AnglesAlone, ABankOfRangesIsBetterAndAsSureAsItMayBe) {
  const Comparison comparison = run("angles_only", 150);
  for (const char* quantity : {"position_m", "velocity_mps"}) {
    for (const char* single : {"ekf", "ukf"}) expect_better(comparison, "bank", single, quantity);
    expect_better(comparison, "bank_smoothed", "bank", quantity);
  }
  EXPECT_NEAR(comparison.tracker("bank")->nees, 6.0, 1.5);
  EXPECT_NEAR(comparison.tracker("bank_smoothed")->nees, 6.0, 1.5);
  EXPECT_GT(comparison.tracker("ekf")->nees, 9.0) << "the partner: one filter is too sure of its range";
}

}  // namespace
}  // namespace truebearing::range_rate_acceptance_test
