// SPDX-License-Identifier: Apache-2.0
#include "truebearing/motion/with_frequency.hpp"

#include <gtest/gtest.h>

#include "truebearing/motion/constant_acceleration.hpp"
#include "truebearing/motion/constant_velocity.hpp"

namespace truebearing::with_frequency_test {
namespace {

constexpr double kT = 7.0;

TEST(WithFrequency, PutsTheFrequencyBehindTheVelocities) {
  const ConstantVelocity<2, ContinuousWhiteNoise> motion{{0.3}};
  const WithFrequency<ConstantVelocity<2, ContinuousWhiteNoise>> whole{motion, 0.01};
  Eigen::Matrix<double, 5, 5> F = Eigen::Matrix<double, 5, 5>::Identity(), Q = Eigen::Matrix<double, 5, 5>::Zero();
  F(0, 2) = F(1, 3) = kT;
  Q.topLeftCorner<4, 4>() = motion.Q(kT);
  Q(4, 4) = 0.07;
  EXPECT_EQ(whole.F(kT), F);
  EXPECT_TRUE(whole.Q(kT).isApprox(Q, 1e-15));
}

// Kim and Song, equation 7.
TEST(WithFrequency, OfAccelerationsIsThePapersTransition) {
  const WithFrequency<ConstantAcceleration<2>> whole{{{1e-6}}};
  Eigen::Matrix<double, 7, 7> F = Eigen::Matrix<double, 7, 7>::Identity();
  F(0, 2) = F(1, 3) = F(2, 5) = F(3, 6) = kT;
  F(0, 5) = F(1, 6) = kT * kT / 2;
  EXPECT_EQ(whole.F(kT), F);
  const Eigen::Matrix<double, 7, 7> Q = whole.Q(kT);
  EXPECT_TRUE(Q.row(4).isZero(0.0));
  EXPECT_TRUE(Q.col(4).isZero(0.0));
  const Eigen::Matrix<double, 6, 6> part = whole.motion.Q(kT);
  EXPECT_EQ(Q(0, 5), part(0, 4));
  EXPECT_EQ(Q(5, 0), part(4, 0));
  EXPECT_EQ(Q(6, 6), part(5, 5));
  EXPECT_EQ(Q(1, 3), part(1, 3));
}

TEST(WithFrequency, AddsNothingInNoTime) {
  const WithFrequency<ConstantVelocity<2, ContinuousWhiteNoise>> whole{{{0.3}}, 0.01};
  EXPECT_TRUE(whole.F(0.0).isIdentity(0.0));
  EXPECT_TRUE(whole.Q(0.0).isZero(0.0));
}

}  // namespace
}  // namespace truebearing::with_frequency_test
