// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tma/modified_polar.hpp"

#include <gtest/gtest.h>

#include "tests/support/bearing_runs.hpp"
#include "tests/support/jacobian.hpp"

namespace truebearing::modified_polar_test {
namespace {

using testing::two_legs;

constexpr double kJacobian = 1e-6;
const Eigen::Vector4d kTarget(3000.0, 5000.0, -2.0, 1.0);  // at time 0
const Eigen::Vector4d kSteps(1e-4, 1e-7, 1e-7, 1e-8);

Eigen::Vector4d at(const ModifiedPolar& polar, Eigen::Vector4d x) {
  x.head<2>() += polar.origin_s() * x.tail<2>();
  return polar.from_cartesian(x);
}

TEST(ModifiedPolar, ThereAndBackIsTheSameState) {
  const BearingWindow window = two_legs(kTarget, 300.0, 600.0);
  ModifiedPolar polar;
  polar.look_at(window);
  const Eigen::Vector4d x = polar.to_cartesian(at(polar, kTarget));
  EXPECT_LT((x.head<2>() - (kTarget.head<2>() + 300.0 * kTarget.tail<2>())).norm(), 1e-8);
  EXPECT_LT((x.tail<2>() - kTarget.tail<2>()).norm(), 1e-11);
}

TEST(ModifiedPolar, TrueStateExplainsTheBearings) {
  const BearingWindow window = two_legs(kTarget, 300.0, 600.0);
  ModifiedPolar polar;
  polar.look_at(window);
  EXPECT_LT(polar(at(polar, kTarget)).cost, 1e-15);
}

TEST(ModifiedPolar, CostIsTheCartesianOne) {
  const BearingWindow window = two_legs(kTarget, 300.0, 600.0, 1.0);
  ModifiedPolar polar;
  polar.look_at(window);
  const Eigen::Vector4d other = kTarget + Eigen::Vector4d(-800.0, 400.0, 1.0, 2.0);
  EXPECT_NEAR(polar(at(polar, other)).cost / window.cartesian(other, 0.0).cost, 1.0, 1e-10);
}

TEST(ModifiedPolar, GradientIsThatOfTheCost) {
  const BearingWindow window = two_legs(kTarget, 300.0, 600.0, 1.0);
  for (const double huber : {1e300, 0.8}) {
    ModifiedPolar polar(huber);
    polar.look_at(window);
    const Eigen::Vector4d y = at(polar, kTarget) + Eigen::Vector4d(0.01, 1e-5, 2e-5, 2e-5);
    const auto cost = [&](const Eigen::Vector4d& p) { return Eigen::Matrix<double, 1, 1>(polar(p).cost); };
    const Eigen::Matrix<double, 1, 4> numeric = testing::central_differences(cost, y, kSteps);
    const Eigen::Vector4d gradient = polar(y).gradient;
    for (int i = 0; i < 4; ++i) EXPECT_NEAR(-gradient[i] / numeric[i], 1.0, 1e-5) << i << " " << huber;
  }
}

// At the true state residuals vanish and the curvature of the cost is J'WJ.
TEST(ModifiedPolar, NormalMatrixIsTheCurvatureAtTheTruth) {
  const BearingWindow window = two_legs(kTarget, 300.0, 600.0);
  ModifiedPolar polar;
  polar.look_at(window);
  const Eigen::Vector4d y = at(polar, kTarget);
  const auto gradient = [&](const Eigen::Vector4d& p) { return Eigen::Vector4d(-polar(p).gradient); };
  const Eigen::Matrix4d curvature = testing::central_differences(gradient, y, kSteps);
  const Eigen::Matrix4d A = polar(y).A;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) EXPECT_NEAR(curvature(i, j), A(i, j), 1e-5 * std::sqrt(A(i, i) * A(j, j))) << i << j;
}

TEST(ModifiedPolar, JacobianIsTheDerivativeOfTheState) {
  const BearingWindow window = two_legs(kTarget, 300.0, 600.0);
  ModifiedPolar polar;
  polar.look_at(window);
  const Eigen::Vector4d y = at(polar, kTarget);
  const auto state = [&](const Eigen::Vector4d& p) { return polar.to_cartesian(p); };
  const Eigen::Matrix4d numeric = testing::central_differences(state, y, kSteps);
  EXPECT_LT((polar.jacobian(y) - numeric).norm(), kJacobian * numeric.norm());
}

TEST(ModifiedPolar, WithoutAManoeuvreTheRangeDropsOut) {
  const BearingWindow window = two_legs(kTarget, 1e9, 600.0, 1.0);
  ModifiedPolar polar;
  polar.look_at(window);
  EXPECT_LT(polar.departure_m(), 1e-9);
  Eigen::Vector4d near = at(polar, kTarget), far = near;
  far[3] *= 0.1;
  EXPECT_NEAR(polar(near).cost, polar(far).cost, 1e-9);
}

TEST(ModifiedPolar, StartRegressesBearingsAcrossTheSeam) {
  BearingWindow window;
  for (int k = 0; k <= 10; ++k) window.add(k, wrap_pi(kPi - 0.05 + 0.01 * k), 0.02, {0.0, 0.0});
  ModifiedPolar polar;
  polar.look_at(window);
  const Eigen::Vector4d start = polar.start(4000.0);
  EXPECT_NEAR(wrap_pi(start[0] - kPi), 0.0, 1e-12);
  EXPECT_NEAR(start[1], 0.01, 1e-12);
  EXPECT_EQ(start[3], 1.0 / 4000.0);
}

}  // namespace
}  // namespace truebearing::modified_polar_test
