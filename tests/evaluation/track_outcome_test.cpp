// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/track_outcome.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "tests/support/line_trackers.hpp"

#include "truebearing/core/constants.hpp"

namespace truebearing::track_outcome_test {
namespace {

using Values = std::vector<double>;

const TrackRule kRule{.quantity = "angle_deg", .bad = 3.0, .last_steps = 2, .excursion = 6.0};

// Two targets over four steps, at 0 and at 20.
const Values kTruth{0, 0, 0, 0, 20, 20, 20, 20};

TrackOutcome outcome(const Values& estimates, const Values& truth = kTruth) {
  return track_outcome(truth, estimates, 2, kRule);
}

TEST(TrackOutcome, TracksThatFollowAreClean) {
  const TrackOutcome found = outcome({1, -5, 2, 3, 21, 20, 17, 18});
  EXPECT_TRUE(found.is_clean());
  EXPECT_FALSE(found.is_swap() || found.is_loss() || found.excursion);
}

TEST(TrackOutcome, BothThatChangedOverAreASwap) {
  const TrackOutcome found = outcome({0, 0, 19, 20, 20, 20, 1, 1});
  EXPECT_EQ(found.swapped, 2);
  EXPECT_EQ(found.lost, 0);
  EXPECT_TRUE(found.is_swap());
  EXPECT_TRUE(found.excursion) << "a swap goes a long way";
  EXPECT_FALSE(found.is_clean());
}

TEST(TrackOutcome, ATrackNearNoTargetIsLost) {
  const TrackOutcome found = outcome({0, 0, 9, 10, 20, 20, 20, 20});
  EXPECT_EQ(found.swapped, 0);
  EXPECT_EQ(found.lost, 1);
  EXPECT_TRUE(found.is_loss());
}

TEST(TrackOutcome, ASwapRunIsNoLossRun) {
  // The first joins the second, the second is lost.
  const TrackOutcome found = outcome({0, 0, 20, 20, 20, 20, 50, 50});
  EXPECT_EQ(found.swapped, 1);
  EXPECT_EQ(found.lost, 1);
  EXPECT_TRUE(found.is_swap());
  EXPECT_FALSE(found.is_loss());
}

TEST(TrackOutcome, ErrorsAreSigned) {
  const TrackOutcome found = outcome({0, 0, -5, 5, 20, 20, 24, 17});
  EXPECT_TRUE(found.is_clean()) << "on the mean they are there";
  EXPECT_EQ(outcome({0, 0, 4, 4, 20, 20, 20, 20}).lost, 1) << "these are not";
}

TEST(TrackOutcome, OnlyTheLastStepsJudge) {
  const TrackOutcome found = outcome({0, 20, 0, 0, 20, 0, 20, 20});
  EXPECT_EQ(found.swapped + found.lost, 0) << "they found back";
  EXPECT_TRUE(found.excursion);
  EXPECT_FALSE(found.is_clean());
}

TEST(TrackOutcome, ATrackWithoutRecordsAtTheEndIsLost) {
  EXPECT_EQ(outcome({0, 0, kNaN, kNaN, 20, 20, 20, 20}).lost, 1);
  EXPECT_TRUE(outcome({0, 0, kNaN, 1, 20, 20, 20, 20}).is_clean()) << "one that has a gap is not";
}

TEST(TrackOutcome, ATargetIsJudgedWhileItIsThere) {
  const Values truth{0, 0, kNaN, kNaN, 20, 20, 20, 20};
  EXPECT_TRUE(outcome({1, 1, 80, 80, 20, 20, 20, 20}, truth).is_clean()) << "gone after the second step";
  EXPECT_EQ(outcome({20, 20, 0, 0, 20, 20, 20, 20}, truth).swapped, 1);
  const Values never{0, 0, 0, 0, kNaN, kNaN, kNaN, kNaN};
  EXPECT_TRUE(outcome({0, 0, 0, 0, 50, 50, 50, 50}, never).is_clean());
}

}  // namespace
}  // namespace truebearing::track_outcome_test
