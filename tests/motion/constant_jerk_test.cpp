// SPDX-License-Identifier: Apache-2.0
#include "truebearing/motion/constant_jerk.hpp"

#include <gtest/gtest.h>

#include "tests/motion/linear_motion.hpp"

namespace truebearing::constant_jerk_test {
namespace {

constexpr double kAlgebra = 1e-12;

TEST(ConstantJerk, IsALinearMotion) {
  testing::expect_linear_motion(ConstantJerk<1>{0.3});
  testing::expect_linear_motion(ConstantJerk<2>{0.3});
}

TEST(ConstantJerk, MovesByItsJerk) {
  const Eigen::Vector4d next = ConstantJerk<1>{1.0}.F(2.0) * Eigen::Vector4d(100.0, -3.0, 0.5, 6.0);
  EXPECT_TRUE(next.isApprox(Eigen::Vector4d(100.0 - 6.0 + 1.0 + 8.0, -3.0 + 1.0 + 12.0, 12.5, 6.0), kAlgebra));
}

TEST(ConstantJerk, HasTheProcessNoiseOfTheIntegral) {
  const double q = 3.0;
  Eigen::Matrix4d expected;  // dt = 1
  expected << 1.0 / 252, 1.0 / 72, 1.0 / 30, 1.0 / 24, 1.0 / 72, 1.0 / 20, 1.0 / 8, 1.0 / 6, 1.0 / 30, 1.0 / 8, 1.0 / 3,
      1.0 / 2, 1.0 / 24, 1.0 / 6, 1.0 / 2, 1.0;
  EXPECT_TRUE(ConstantJerk<1>{q}.Q(1.0).isApprox(q * expected, kAlgebra));
}

TEST(ConstantJerk, AccumulatesOverPartsOfAStep) {
  testing::expect_noise_of_parts_is_that_of_the_whole(ConstantJerk<1>{0.7}, 0.4, 1.3, kAlgebra);
}

}  // namespace
}  // namespace truebearing::constant_jerk_test
