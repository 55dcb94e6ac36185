// SPDX-License-Identifier: Apache-2.0
#include "truebearing/motion/coordinated_turn.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/motion/linear_motion.hpp"
#include "truebearing/core/angle.hpp"
#include "truebearing/motion/constant_velocity.hpp"

namespace truebearing::coordinated_turn_test {
namespace {

constexpr double kAlgebra = 1e-12;

using Turn = CoordinatedTurn<ContinuousWhiteNoise>;

double course_rad(const Eigen::Vector4d& x) {
  return std::atan2(x(2), x(3));
}

TEST(CoordinatedTurn, IsALinearMotion) {
  for (const double rate_radps : {-0.3, -1e-9, 0.0, 1e-5, 0.1, 2.0}) {
    SCOPED_TRACE(rate_radps);
    testing::expect_linear_motion(Turn{{2.0}, rate_radps});
  }
}

TEST(CoordinatedTurn, TurnsToStarboardAtItsRateAndKeepsItsSpeed) {
  const Eigen::Vector4d x(1000.0, -500.0, 30.0, 40.0);
  for (const double rate_radps : {-0.2, -1e-4, 1e-6, 0.05, 0.3})
    for (const double dt_s : {0.1, 1.0, 8.0}) {
      const Eigen::Vector4d next = Turn{{2.0}, rate_radps}.F(dt_s) * x;
      EXPECT_NEAR(next.tail<2>().norm(), 50.0, 50.0 * kAlgebra);
      EXPECT_NEAR(wrap_pi(course_rad(next) - course_rad(x) - rate_radps * dt_s), 0.0, kAlgebra);
    }
}

TEST(CoordinatedTurn, StaysOnACircleAboutAPointAbeam) {
  const double rate_radps = 0.1;
  const Eigen::Vector4d x(0.0, 0.0, 0.0, 50.0);  // due North: the centre of a starboard turn lies to the East
  const Eigen::Vector2d centre_m(500.0, 0.0);
  for (const double dt_s : {1.0, 5.0, 20.0, 60.0}) {
    const Eigen::Vector4d next = Turn{{2.0}, rate_radps}.F(dt_s) * x;
    EXPECT_NEAR((next.head<2>() - centre_m).norm(), 500.0, 500.0 * kAlgebra);
  }
}

TEST(CoordinatedTurn, IsConstantVelocityAtRateZeroAndCloseToItNearby) {
  const ConstantVelocity<2, ContinuousWhiteNoise> straight{{2.0}};
  EXPECT_EQ((Turn{{2.0}, 0.0}.F(3.0)), straight.F(3.0));
  EXPECT_EQ((Turn{{2.0}, 0.4}.Q(3.0)), straight.Q(3.0));
  EXPECT_TRUE((Turn{{2.0}, 1e-14}.F(3.0)).isApprox(straight.F(3.0), kAlgebra));
}

}  // namespace
}  // namespace truebearing::coordinated_turn_test
