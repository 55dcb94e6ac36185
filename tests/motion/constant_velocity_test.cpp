// SPDX-License-Identifier: Apache-2.0
#include "truebearing/motion/constant_velocity.hpp"

#include <gtest/gtest.h>

namespace truebearing::constant_velocity_test {
namespace {

constexpr double kAlgebra = 1e-12;

const Eigen::Matrix2d kPublishedQ = (Eigen::Matrix2d() << 5.0, 0.0, 0.0, 0.1).finished();

template <typename Motion>
void expect_nothing_over_no_time(const Motion& motion) {
  using Matrix = Eigen::Matrix<double, Motion::kStates, Motion::kStates>;
  EXPECT_EQ(motion.F(0.0), Matrix::Identity());
  EXPECT_EQ(motion.Q(0.0), Matrix::Zero());
}

TEST(ConstantVelocity, DoesNothingOverNoTime) {
  expect_nothing_over_no_time(ConstantVelocity<1, ContinuousWhiteNoise>{{2.0}});
  expect_nothing_over_no_time(ConstantVelocity<2, DiscreteWhiteNoise>{{1.5}});
  expect_nothing_over_no_time(ConstantVelocity<1, FixedNoise<2>>{{kPublishedQ, 1.0}});
}

TEST(ConstantVelocity, MovesPositionsByVelocities) {
  const ConstantVelocity<2, ContinuousWhiteNoise> motion{{1.0}};
  const Eigen::Vector4d x = motion.F(2.0) * Eigen::Vector4d(100.0, 200.0, -3.0, 4.0);
  EXPECT_EQ(x, Eigen::Vector4d(94.0, 208.0, -3.0, 4.0));
}

TEST(ConstantVelocity, HasThePublishedProcessNoise) {
  const double dt_s = 3.0;
  const Eigen::Matrix4d Q = ConstantVelocity<2, ContinuousWhiteNoise>{{2.0}}.Q(dt_s);
  Eigen::Matrix4d expected;
  expected << 18, 0, 9, 0, 0, 18, 0, 9, 9, 0, 6, 0, 0, 9, 0, 6;
  EXPECT_TRUE(Q.isApprox(expected, kAlgebra));
  const Eigen::Matrix2d discrete = ConstantVelocity<1, DiscreteWhiteNoise>{{2.0}}.Q(dt_s);
  EXPECT_TRUE(discrete.isApprox((Eigen::Matrix2d() << 81, 54, 54, 36).finished(), kAlgebra));
}

TEST(ContinuousWhiteNoise, AccumulatesOverPartsOfAStep) {
  const ConstantVelocity<1, ContinuousWhiteNoise> motion{{0.7}};
  const double a = 0.4, b = 1.3;
  EXPECT_TRUE((motion.F(b) * motion.Q(a) * motion.F(b).transpose() + motion.Q(b)).isApprox(motion.Q(a + b), kAlgebra));
}

TEST(FixedNoise, IsThePublishedMatrixOverItsPeriodAndInProportionElsewhere) {
  const ConstantVelocity<1, FixedNoise<2>> motion{{kPublishedQ, 4.0}};
  EXPECT_EQ(motion.Q(4.0), kPublishedQ);
  EXPECT_TRUE((motion.Q(1.0) + motion.Q(2.5)).isApprox(motion.Q(3.5), kAlgebra));
}

}  // namespace
}  // namespace truebearing::constant_velocity_test
