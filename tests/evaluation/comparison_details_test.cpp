// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/comparison_details.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "truebearing/core/chi_square.hpp"
#include "truebearing/core/constants.hpp"

namespace truebearing::comparison_details_test {
namespace {

RunScore run_of(std::vector<double> errors, std::vector<double> nees, std::size_t targets = 1) {
  RunScore run;
  run.targets = targets;
  run.error = {std::move(errors)};
  run.nees = std::move(nees);
  run.quantity_nees = {run.nees};
  return run;
}

TEST(ComparisonDetails, KeepTheErrorOfEachRun) {
  DetailsTally tally(2);
  tally.add(run_of({kNaN, 3.0, 4.0}, {kNaN, 1.0, 2.0}));
  tally.add(run_of({kNaN, 1.0, 1.0}, {kNaN, 3.0, 4.0}));
  tally.add(run_of({kNaN, kNaN, kNaN}, {kNaN, kNaN, kNaN}));
  const TrackerDetails details = tally.details();
  ASSERT_EQ(details.run_rmse[0].size(), 3u);
  EXPECT_DOUBLE_EQ(details.run_rmse[0][0], std::sqrt(12.5));
  EXPECT_DOUBLE_EQ(details.run_rmse[0][1], 1.0);
  EXPECT_TRUE(std::isnan(details.run_rmse[0][2]));
  EXPECT_TRUE(std::isnan(details.nees[0]));
  EXPECT_DOUBLE_EQ(details.nees[1], 2.0);
  EXPECT_DOUBLE_EQ(details.nees_low[1], chi_square_quantile(0.025, 4.0) / 2.0);
  EXPECT_DOUBLE_EQ(details.nees_high[2], chi_square_quantile(0.975, 4.0) / 2.0);
}

// Squares 1 and 9: mean 5, standard error of the mean 4; of the root 4 / (2 sqrt 5).
TEST(ComparisonDetails, StandardErrorOfAStepIsThatOfItsRoot) {
  DetailsTally tally(1);
  tally.add(run_of({1.0}, {1.0}));
  EXPECT_TRUE(std::isnan(tally.details().series_se[0][0])) << "of one run";
  tally.add(run_of({3.0}, {1.0}));
  EXPECT_NEAR(tally.details().series_se[0][0], 2.0 / std::sqrt(5.0), 1e-12);
}

// Errors of targets in one run are not independent: the run counts once.
TEST(ComparisonDetails, RunsCountOnceHoweverManyTargets) {
  DetailsTally two(1), one(1);
  for (const double error : {1.0, 3.0, 2.0}) {
    two.add(run_of({error, error}, {1.0, 1.0}, 2));
    one.add(run_of({error}, {1.0}));
  }
  EXPECT_DOUBLE_EQ(two.details().series_se[0][0], one.details().series_se[0][0]);
}

}  // namespace
}  // namespace truebearing::comparison_details_test
