// SPDX-License-Identifier: Apache-2.0
// A laser scanner and a Doppler radar that take turns: filters that know that the target turns, and the correction of
// one, against the filter that the exercise asks for.
#include <gtest/gtest.h>

#include "tests/support/comparisons.hpp"
#include "tests/support/real_data.hpp"

namespace truebearing::laser_radar_test {
namespace {

using testing::load_study;

TEST(LaserRadar, WhoKnowsThatItTurnsIsBetterThanTheStandardFilter) {
  const Study study = load_study("laser_radar");
  ComparisonOptions options = study.comparison_options();
  options.runs = 100;
  options.seed = 20;
  const Comparison comparison = compare(study.make_tracker_set(), study.evaluation_scenarios(), options);
  for (const char* quantity : {"position_m", "velocity_mps"}) {
    for (const char* knowing : {"turning", "imm", "imm_nfnn"}) {
      const PairedDifference found = testing::difference(comparison, knowing, "standard", quantity);
      EXPECT_LT(found.mean + 5.0 * found.se, 0.0) << knowing << ", " << quantity;
    }
    testing::expect_better(comparison, "imm_nfnn", "imm", quantity);
    // Both sensors tell more than either.
    for (const char* alone : {"by_laser", "by_radar"})
      EXPECT_LT(comparison.tracker("standard")->quantity(quantity)->rmse,
                comparison.tracker(alone)->quantity(quantity)->rmse);
  }
  EXPECT_GT(comparison.tracker("imm_nfnn")->nees, 3.6);
  EXPECT_LT(comparison.tracker("imm_nfnn")->nees, 4.4);
}

}  // namespace
}  // namespace truebearing::laser_radar_test
