// SPDX-License-Identifier: Apache-2.0
#include "truebearing/motion/with_vertical.hpp"

#include <gtest/gtest.h>

#include "tests/motion/linear_motion.hpp"
#include "tests/support/jacobian.hpp"
#include "truebearing/core/random.hpp"
#include "truebearing/motion/constant_velocity.hpp"
#include "truebearing/motion/singer.hpp"
#include "truebearing/motion/turning_target.hpp"

namespace truebearing::with_vertical_test {
namespace {

constexpr double kT_s = 7.0;

template <int Dim>
using Straight = ConstantVelocity<Dim, ContinuousWhiteNoise>;
using Turn = WithVertical<CoordinatedTurn<ContinuousWhiteNoise>, Straight<1>>;
using Turning = WithVertical<TurningTarget<ContinuousWhiteNoise>, Straight<1>>;

// With the same noise in all directions, motions that have a form of their own in space.
TEST(WithVertical, IsTheMotionInSpace) {
  const WithVertical<Straight<2>, Straight<1>> straight{{{0.3}}, {{0.3}}};
  EXPECT_EQ(straight.F(kT_s), Straight<3>{{0.3}}.F(kT_s));
  EXPECT_EQ(straight.Q(kT_s), Straight<3>{{0.3}}.Q(kT_s));
  const WithVertical<Singer<2>, Singer<1>> manoeuvring{{2.0, 20.0}, {2.0, 20.0}};
  const Singer<3> whole{2.0, 20.0};
  EXPECT_EQ(manoeuvring.F(kT_s), whole.F(kT_s));
  EXPECT_EQ(manoeuvring.Q(kT_s), whole.Q(kT_s));
}

TEST(WithVertical, TurnsInThePlaneAndClimbsAboveIt) {
  const CoordinatedTurn<ContinuousWhiteNoise> level{{2.0}, 0.05};
  const Turn turn{level, {{0.1}}};
  const Eigen::Matrix<double, 6, 1> x{100.0, -200.0, 3000.0, 50.0, 60.0, -4.0}, next = turn.F(kT_s) * x;
  const Eigen::Vector4d plane = level.F(kT_s) * Eigen::Vector4d(100.0, -200.0, 50.0, 60.0);
  EXPECT_TRUE(next.isApprox(
      Eigen::Matrix<double, 6, 1>{plane[0], plane[1], 3000.0 - 4.0 * kT_s, plane[2], plane[3], -4.0}, 1e-14));
  const Eigen::Matrix<double, 6, 6> Q = turn.Q(kT_s);
  EXPECT_EQ(Q(3, 3), level.Q(kT_s)(2, 2));
  EXPECT_EQ(Q(5, 5), 0.1 * kT_s);
  EXPECT_TRUE(Q.row(2).head<2>().isZero(0.0)) << "nothing couples up with the plane";
  testing::expect_linear_motion(turn);
}

TEST(WithVertical, OfAnEstimatedRateHasTheJacobianOfCentralDifferences) {
  using State = Turning::State;
  const Turning motion{{{2.0}, 0.01}, {{0.1}}};
  RandomStream random({31, Role::evaluation, 0}, StreamId::test);
  const State step{1e-2, 1e-2, 1e-2, 1e-2, 1e-2, 1e-2, 1e-5};
  for (int trial = 0; trial < 100; ++trial) {
    State x;
    for (double& value : x) value = 100.0 * random.normal();
    x(6) = 0.1 * random.normal();
    const Turning::Matrix expected =
        testing::central_differences([&](const State& at) { return motion.f(at, kT_s); }, x, step);
    const Turning::Matrix difference = (motion.F(x, kT_s) - expected).cwiseAbs();
    EXPECT_TRUE((difference.array() <= 1e-6 * (1.0 + expected.array().abs())).all()) << difference;
  }
  EXPECT_EQ(motion.f(step, 0.0), step);
  EXPECT_TRUE(motion.F(step, 0.0).isIdentity(0.0));
  EXPECT_TRUE(motion.Q(0.0).isZero(0.0));
  EXPECT_NEAR(motion.Q(kT_s)(6, 6), 1e-4 * kT_s, 1e-15);
}

TEST(WithVertical, IsTheTargetOfThePlaneWhereItFliesLevel) {
  const TurningTarget<ContinuousWhiteNoise> level{{2.0}, 0.01};
  const Turning motion{level, {{0.1}}};
  const Turning::State x{10.0, 20.0, 0.0, 30.0, 40.0, 0.0, 0.02}, next = motion.f(x, kT_s);
  const Eigen::Matrix<double, 5, 1> plane = level.f({10.0, 20.0, 30.0, 40.0, 0.02}, kT_s);
  EXPECT_EQ(next, (Turning::State{plane[0], plane[1], 0.0, plane[2], plane[3], 0.0, plane[4]}));
}

}  // namespace
}  // namespace truebearing::with_vertical_test
