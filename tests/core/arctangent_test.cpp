// SPDX-License-Identifier: Apache-2.0
#include "truebearing/core/arctangent.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "truebearing/core/random.hpp"

namespace truebearing::arctangent_test {
namespace {

constexpr double kTolerance = 5e-16;

TEST(Arctangent, IsAtan2AllAround) {
  for (int i = -3600; i <= 3600; ++i) {
    const double angle = i * std::numbers::pi / 3600.0;
    for (const double length : {1e-150, 1e-3, 1.0, 7.0, 1e150}) {
      const double s = length * std::sin(angle), c = length * std::cos(angle);
      EXPECT_NEAR(arctangent(s, c), std::atan2(s, c), kTolerance) << angle << " " << length;
    }
  }
}

TEST(Arctangent, IsAtan2OfAnyTwoNumbers) {
  RandomStream stream({1, Role::evaluation, 0}, StreamId::test);
  for (int i = 0; i < 100000; ++i) {
    const double s = stream.normal() * std::exp(10.0 * stream.normal()), c = stream.normal();
    ASSERT_NEAR(arctangent(s, c), std::atan2(s, c), kTolerance) << s << " " << c;
  }
}

TEST(Arctangent, OfTinyAnglesIsRelativelyExact) {
  for (const double t : {1e-300, 1e-20, 1e-9, 1e-4})
    EXPECT_NEAR(arctangent(t, 1.0) / std::atan2(t, 1.0), 1.0, kTolerance) << t;
}

TEST(Arctangent, OfTheAxesIsExactAndOfNothingIsNoNumber) {
  EXPECT_EQ(arctangent(0.0, 2.0), 0.0);
  EXPECT_EQ(arctangent(3.0, 0.0), 0.5 * std::numbers::pi);
  EXPECT_EQ(arctangent(-3.0, 0.0), -0.5 * std::numbers::pi);
  EXPECT_EQ(arctangent(0.0, -1.0), std::numbers::pi);
  EXPECT_TRUE(std::isnan(arctangent(0.0, 0.0)));
}

}  // namespace
}  // namespace truebearing::arctangent_test
