// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tma/other_explanations.hpp"

#include <gtest/gtest.h>

#include "tests/support/bearing_runs.hpp"
#include "truebearing/tma/target_motion_batch.hpp"

namespace truebearing::other_explanations_test {
namespace {

using testing::two_legs;

const Eigen::Vector4d kOne(3000.0, 5000.0, -2.0, 1.0), kOther(-4000.0, 6000.0, 3.0, -1.0);

BearingWindow mixed(const BearingWindow& one, const BearingWindow& other, std::size_t every) {
  BearingWindow window;
  for (std::size_t i = 0; i < one.size(); ++i) {
    const BearingWindow& from = i % every == 0 ? other : one;
    window.add(from.time_s(i), from.bearing_rad(i), radians(1.0), from.site_m(i));
  }
  return window;
}

TEST(OtherExplanations, TwoContactsArePartedFromEachOther) {
  const BearingWindow window = mixed(two_legs(kOne, 300.0, 1200.0, 1.0, 0), two_legs(kOther, 300.0, 1200.0, 1.0, 1), 3);
  TargetMotionBatch batch;
  const auto two = find_two_contacts(window, batch.solve(window));
  ASSERT_TRUE(two);
  EXPECT_EQ(std::min(two->count[0], two->count[1]), 41u);
  EXPECT_EQ(std::max(two->count[0], two->count[1]), 80u);
}

TEST(OtherExplanations, OneContactIsNotTwo) {
  const BearingWindow noisy = two_legs(kOne, 300.0, 1200.0, 3.0);
  TargetMotionBatch batch;
  EXPECT_FALSE(find_two_contacts(noisy, batch.solve(noisy)));
}

TEST(OtherExplanations, BearingsOfTheOtherEndAreRecognised) {
  const BearingWindow right = two_legs(kOne, 300.0, 1200.0, 1.0);
  BearingWindow reversed;
  for (std::size_t i = 0; i < right.size(); ++i)
    reversed.add(right.time_s(i), right.bearing_rad(i) + kPi, radians(1.0), right.site_m(i));
  TargetMotionBatch batch;
  const BatchEstimate expected = batch.solve(right);
  const auto found = find_reversed(reversed, batch.solve(reversed));
  ASSERT_TRUE(found);
  EXPECT_LT((found->x - expected.x).norm(), 1.0);
  EXPECT_FALSE(find_reversed(right, expected));
}

}  // namespace
}  // namespace truebearing::other_explanations_test
