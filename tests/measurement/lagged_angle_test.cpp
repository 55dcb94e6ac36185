// SPDX-License-Identifier: Apache-2.0
#include "truebearing/measurement/lagged_angle.hpp"

#include <gtest/gtest.h>

#include "tests/support/jacobian.hpp"
#include "truebearing/filter/kalman.hpp"
#include "truebearing/motion/constant_velocity.hpp"

namespace truebearing::lagged_angle_test {
namespace {

using Vector = LaggedAngle::Vector;

TEST(LaggedAngle, IsTheAngleThatATargetHadThen) {
  const Eigen::Vector2d then(0.3, -0.02);
  const ConstantVelocity<1, ContinuousWhiteNoise> motion{{0.0}};
  const Eigen::Vector2d now = motion.F(0.63) * then;
  EXPECT_NEAR((LaggedAngle{0.63, 1.0}.h(now)[0]), 0.3, 1e-15);
  EXPECT_EQ((LaggedAngle{0.0, 1.0}.h(now)[0]), now[0]);
}

TEST(LaggedAngle, JacobianIsThatOfFiniteDifferences) {
  const LaggedAngle model{0.27, 4.0};
  const Eigen::Vector2d x(0.3, -0.02), step(1e-5, 1e-5);
  const auto differences =
      testing::central_differences([&](const Eigen::Vector2d& at) { return model.h(at); }, x, step);
  EXPECT_LT((model.H(x) - differences).norm(), 1e-6);
  EXPECT_EQ(model.R()(0, 0), 4.0);
}

TEST(LaggedAngle, ResidualDoesNotWrap) {
  EXPECT_EQ((LaggedAngle{}.residual(Vector(3.5), Vector(-3.5))[0]), 7.0);
}

// A filter that is told of angles some time late stays behind without a lag in its model, by lag times rate.
TEST(LaggedAngle, TakesTheLagOutOfAFilter) {
  constexpr double kLag_s = 0.4, kRate_radps = 0.05;
  const auto final_error = [&](double model_lag_s) {
    const ConstantVelocity<1, ContinuousWhiteNoise> motion{{1e-8}};
    KalmanFilter<2> filter(Eigen::Vector2d::Zero(), Eigen::Vector2d(1.0, 1.0).asDiagonal());
    for (int k = 1; k <= 50; ++k) {
      filter.predict(motion, 1.0);
      filter.update(LaggedAngle{model_lag_s, 1e-4}, Vector(kRate_radps * (k - kLag_s)));
    }
    return filter.x()[0] - kRate_radps * 50.0;
  };
  EXPECT_NEAR(final_error(kLag_s), 0.0, 1e-4);
  EXPECT_NEAR(final_error(0.0), -kLag_s * kRate_radps, 1e-4);
}

}  // namespace
}  // namespace truebearing::lagged_angle_test
