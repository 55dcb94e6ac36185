// SPDX-License-Identifier: Apache-2.0
#include "truebearing/motion/singer.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/motion/linear_motion.hpp"
#include "truebearing/motion/constant_velocity.hpp"

namespace truebearing::singer_test {
namespace {

constexpr double kAlgebra = 1e-12;

TEST(Singer, IsALinearMotion) {
  for (const double time_constant_s : {1e-3, 1.0, 20.0, 1e6}) {
    SCOPED_TRACE(time_constant_s);
    testing::expect_linear_motion(Singer<1>{3.0, time_constant_s});
  }
  testing::expect_linear_motion(Singer<2>{3.0, 20.0});
}

TEST(Singer, NoiseOfPartsIsThatOfTheWhole) {
  const Singer<2> motion{3.0, 10.0};
  for (const double dt_s : {1e-6, 1e-3, 0.1, 1.0, 4.9, 30.0, 1e3})
    testing::expect_noise_of_parts_is_that_of_the_whole(motion, 0.4 * dt_s, 0.6 * dt_s, kAlgebra);
}

TEST(Singer, SeriesMeetsTheClosedForm) {
  const Singer<1> motion{3.0, 10.0};
  const double dt_s = 5.0;
  const Eigen::Matrix3d below = motion.Q(std::nextafter(dt_s, 0.0)), at = motion.Q(dt_s);
  EXPECT_LT(testing::scaled_difference(below, at), kAlgebra);
  EXPECT_TRUE(motion.F(std::nextafter(dt_s, 0.0)).isApprox(motion.F(dt_s), kAlgebra));
}

TEST(Singer, QStaysACovarianceOverStepsOfAnyLength) {
  for (int exponent = -12; exponent <= 6; ++exponent)
    for (const double mantissa : {1.0, 2.5, 4.99, 5.01}) {
      const Eigen::Matrix3d Q = Singer<1>{3.0, 1.0}.Q(mantissa * std::pow(10.0, exponent));
      EXPECT_TRUE(is_covariance(Q, kAlgebra)) << mantissa << "e" << exponent;
    }
}

TEST(Singer, AccelerationForgetsAndKeepsItsVariance) {
  const Singer<1> motion{3.0, 10.0};
  const double dt_s = 7.0;
  EXPECT_NEAR(motion.F(dt_s)(2, 2), std::exp(-0.7), kAlgebra);
  EXPECT_NEAR(9.0 * motion.F(dt_s)(2, 2) * motion.F(dt_s)(2, 2) + motion.Q(dt_s)(2, 2), 9.0, 9.0 * kAlgebra);
}

// What is left of the one limit is of the order dt / time constant, of the other time constant / dt: 2e-7 each.
TEST(Singer, TendsToConstantAccelerationForSlowManoeuvres) {
  const double time_constant_s = 1e7, density = 0.3, dt_s = 2.0;
  const Singer<2> motion{std::sqrt(density * time_constant_s / 2), time_constant_s};
  const ConstantAcceleration<2> limit{{density}};
  EXPECT_TRUE(motion.F(dt_s).isApprox(limit.F(dt_s), 1e-6));
  EXPECT_LT(testing::scaled_difference(motion.Q(dt_s), limit.Q(dt_s)), 1e-6);
}

TEST(Singer, TendsToConstantVelocityForFastManoeuvres) {
  const double time_constant_s = 4e-7, density = 0.3, dt_s = 2.0;
  const Singer<2> motion{std::sqrt(density / (2 * time_constant_s)), time_constant_s};
  const ConstantVelocity<2, ContinuousWhiteNoise> limit{{density}};
  const Eigen::Matrix4d F = motion.F(dt_s).topLeftCorner<4, 4>(), Q = motion.Q(dt_s).topLeftCorner<4, 4>();
  EXPECT_TRUE(F.isApprox(limit.F(dt_s), 1e-6));
  EXPECT_LT((motion.F(dt_s).rightCols<2>().cwiseAbs().maxCoeff()), 1e-6);
  EXPECT_TRUE(Q.isApprox(limit.Q(dt_s), 1e-6));
}

}  // namespace
}  // namespace truebearing::singer_test
