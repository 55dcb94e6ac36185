// SPDX-License-Identifier: Apache-2.0
#include "truebearing/core/angle.hpp"

#include <gtest/gtest.h>

namespace truebearing::angle_test {
namespace {

TEST(Angle, DegreesAndRadiansAreInverse) {
  EXPECT_DOUBLE_EQ(radians(180.0), kPi);
  EXPECT_DOUBLE_EQ(degrees(kPi / 6.0), 30.0);
  EXPECT_DOUBLE_EQ(degrees(radians(-77.25)), -77.25);
}

TEST(Angle, WrapKeepsTheDirectionAndTheRange) {
  for (const double angle_rad : {0.0, 0.3, -3.1, 3.14}) {
    for (int turns = -50; turns <= 50; ++turns)
      EXPECT_NEAR(wrap_pi(angle_rad + 2.0 * kPi * turns), angle_rad, 1e-12) << angle_rad << " after turns " << turns;
  }
  EXPECT_NEAR(wrap_pi(kPi + 0.25), -kPi + 0.25, 1e-12);
  EXPECT_NEAR(wrap_pi(-kPi - 0.25), kPi - 0.25, 1e-12);
  EXPECT_LE(std::abs(wrap_pi(1e6)), kPi);
}

TEST(Angle, WrapOfNoAngleIsNone) {
  EXPECT_TRUE(std::isnan(wrap_pi(std::nan(""))));
  EXPECT_TRUE(std::isnan(wrap_pi(INFINITY)));
}

}  // namespace
}  // namespace truebearing::angle_test
