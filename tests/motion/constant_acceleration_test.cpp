// SPDX-License-Identifier: Apache-2.0
#include "truebearing/motion/constant_acceleration.hpp"

#include <gtest/gtest.h>

#include "tests/motion/linear_motion.hpp"

namespace truebearing::constant_acceleration_test {
namespace {

constexpr double kAlgebra = 1e-12;

TEST(ConstantAcceleration, IsALinearMotion) {
  testing::expect_linear_motion(ConstantAcceleration<1>{{0.3}});
  testing::expect_linear_motion(ConstantAcceleration<2>{{0.3}});
  testing::expect_linear_motion(ConstantAcceleration<2, DiscreteAccelerationStep>{{1.5}});
}

TEST(ConstantAcceleration, MovesEachDirectionByItsOwnAcceleration) {
  using State = Eigen::Matrix<double, 6, 1>;
  const State x = (State() << 100.0, 200.0, -3.0, 4.0, 0.5, -1.0).finished();
  const State expected = (State() << 95.0, 206.0, -2.0, 2.0, 0.5, -1.0).finished();
  const State next = ConstantAcceleration<2>{{1.0}}.F(2.0) * x;
  EXPECT_TRUE(next.isApprox(expected, kAlgebra));
}

TEST(ContinuousWhiteJerk, HasThePublishedProcessNoise) {
  const double dt_s = 2.0, q = 3.0;
  Eigen::Matrix3d expected;
  expected << 32.0 / 20, 16.0 / 8, 8.0 / 6, 16.0 / 8, 8.0 / 3, 4.0 / 2, 8.0 / 6, 4.0 / 2, 2.0;
  EXPECT_TRUE((ConstantAcceleration<1>{{q}}.Q(dt_s).isApprox(q * expected, kAlgebra)));
}

TEST(ContinuousWhiteJerk, AccumulatesOverPartsOfAStep) {
  testing::expect_noise_of_parts_is_that_of_the_whole(ConstantAcceleration<2>{{0.7}}, 0.4, 1.3, kAlgebra);
}

TEST(DiscreteAccelerationStep, AddsOneIncrementOverTheStep) {
  const Eigen::Vector3d gained(4.5, 3.0, 1.0);
  const Eigen::Matrix3d Q = ConstantAcceleration<1, DiscreteAccelerationStep>{{2.0}}.Q(3.0);
  EXPECT_TRUE(Q.isApprox(4.0 * gained * gained.transpose(), kAlgebra));
}

}  // namespace
}  // namespace truebearing::constant_acceleration_test
