// SPDX-License-Identifier: Apache-2.0
#include "truebearing/motion/turning_target.hpp"

#include <gtest/gtest.h>

#include "tests/support/jacobian.hpp"
#include "truebearing/core/covariance.hpp"
#include "truebearing/core/random.hpp"
#include "truebearing/motion/constant_velocity.hpp"

namespace truebearing::turning_target_test {
namespace {

constexpr double kAlgebra = 1e-12;
constexpr double kJacobian = 1e-6;

using State = Eigen::Matrix<double, 5, 1>;
using Matrix = Eigen::Matrix<double, 5, 5>;

const TurningTarget<ContinuousWhiteNoise> kMotion{{2.0}, 0.01};

State state(double rate_radps) {
  return (State() << 4000.0, -2500.0, 120.0, -90.0, rate_radps).finished();
}

TEST(TurningTarget, DoesNothingOverNoTime) {
  EXPECT_EQ(kMotion.f(state(0.1), 0.0), state(0.1));
  EXPECT_EQ(kMotion.F(state(0.1), 0.0), Matrix::Identity());
  EXPECT_EQ(kMotion.Q(0.0), Matrix::Zero());
}

TEST(TurningTarget, IsConstantVelocityAtRateZero) {
  const ConstantVelocity<2, ContinuousWhiteNoise> straight{{2.0}};
  const State x = state(0.0);
  EXPECT_EQ(kMotion.f(x, 3.0).head<4>(), straight.F(3.0) * x.head<4>());
  EXPECT_EQ((kMotion.F(x, 3.0).topLeftCorner<4, 4>()), straight.F(3.0));
}

TEST(TurningTarget, FollowsTheTurnAtItsOwnRate) {
  const State x = state(-0.07);
  const CoordinatedTurn<ContinuousWhiteNoise> turn{{2.0}, -0.07};
  EXPECT_TRUE(kMotion.f(x, 4.0).head<4>().isApprox(turn.F(4.0) * x.head<4>(), kAlgebra));
  EXPECT_EQ(kMotion.f(x, 4.0)(4), -0.07);
  EXPECT_TRUE(kMotion.f(kMotion.f(x, 1.5), 2.5).isApprox(kMotion.f(x, 4.0), kAlgebra));
}

TEST(TurningTarget, HasTheJacobianOfCentralDifferences) {
  RandomStream random({21, Role::evaluation, 0}, StreamId::test);
  const State step = (State() << 1e-2, 1e-2, 1e-2, 1e-2, 1e-5).finished();
  for (int trial = 0; trial < 200; ++trial) {
    const double dt_s = random.uniform(0.1, 5.0);
    // Rate zero, all sizes of small rates, and rates on either side of where the series ends.
    const double angle_rad = trial == 0 ? 0.0 : random.normal() * std::pow(10.0, random.uniform(-8.0, 0.5));
    State x = state(angle_rad / dt_s);
    x.segment<2>(2) << 100.0 * random.normal(), 100.0 * random.normal();
    const Matrix expected = testing::central_differences([&](const State& at) { return kMotion.f(at, dt_s); }, x, step);
    const Matrix difference = (kMotion.F(x, dt_s) - expected).cwiseAbs();
    EXPECT_TRUE((difference.array() <= kJacobian * (1.0 + expected.array().abs())).all())
        << "angle " << angle_rad << ", dt " << dt_s << "\n"
        << difference;
  }
}

TEST(TurningTarget, SeriesMeetsTheClosedForm) {
  const double below = detail::sinc_derivative(0.25), above = detail::sinc_derivative(std::nextafter(0.25, 1.0));
  EXPECT_NEAR(below, above, kAlgebra * std::abs(above));
  EXPECT_EQ(detail::sinc_derivative(-0.1), -detail::sinc_derivative(0.1));
}

TEST(TurningTarget, RateWandersInProportionToTime) {
  EXPECT_DOUBLE_EQ(kMotion.Q(4.0)(4, 4), 4.0 * 0.01 * 0.01);
  EXPECT_EQ((kMotion.Q(4.0).topLeftCorner<4, 4>()), (ConstantVelocity<2, ContinuousWhiteNoise>{{2.0}}.Q(4.0)));
  EXPECT_TRUE(is_covariance(kMotion.Q(4.0)));
}

}  // namespace
}  // namespace truebearing::turning_target_test
