// SPDX-License-Identifier: Apache-2.0
#include "truebearing/motion/lorenz.hpp"

#include <gtest/gtest.h>

#include "tests/support/jacobian.hpp"
#include "truebearing/core/random.hpp"

namespace truebearing::lorenz_test {
namespace {

constexpr double kAlgebra = 1e-12;
constexpr double kJacobian = 1e-6;

using Eigen::Matrix3d;
using Eigen::Vector3d;

const LorenzMotion<LorenzTaylor> kTaylor{{5}, 0.02, 0.3};
const LorenzMotion<LorenzRungeKutta> kRungeKutta{{}, 0.02, 0.3};

// On the attractor, as far as it spreads.
Vector3d state(RandomStream& random) {
  return {8.0 * random.normal(), 9.0 * random.normal(), 23.0 + 8.0 * random.normal()};
}

TEST(Lorenz, DoesNothingOverNoTime) {
  const Vector3d x(1.0, -2.0, 20.0);
  EXPECT_EQ(kTaylor.f(x, 0.0), x);
  EXPECT_EQ(kRungeKutta.f(x, 0.0), x);
  EXPECT_EQ(kTaylor.F(x, 0.0), Matrix3d::Identity());
  EXPECT_EQ(kRungeKutta.F(x, 0.0), Matrix3d::Identity());
  EXPECT_EQ(kTaylor.Q(0.0), Matrix3d::Zero());
}

// [I + A h + (A h)^2 / 2] x by hand.
TEST(Lorenz, TaylorIsTheSeriesOfAFrozenMatrix) {
  const Vector3d x(3.0, -4.0, 25.0);
  Matrix3d A;
  A << -10.0, 10.0, 0.0, 28.0 - 25.0, -1.0, 0.0, -4.0, 0.0, -8.0 / 3.0;
  const Matrix3d Ah = 0.02 * A;
  const Vector3d expected = (Matrix3d::Identity() + Ah + Ah * Ah / 2.0) * x;
  EXPECT_LT((LorenzMotion<LorenzTaylor>{{2}, 0.02}.f(x, 0.02) - expected).norm(), kAlgebra * expected.norm());
}

// Halving the step of a method of order p divides its error by 2^p.
TEST(Lorenz, OrdersAreOneAndFour) {
  const Vector3d x(3.0, -4.0, 25.0), truth = LorenzMotion<LorenzRungeKutta>{{}, 1e-4}.f(x, 0.08);
  const auto error = [&](const auto& motion) { return (motion.f(x, 0.08) - truth).norm(); };
  const double taylor = error(LorenzMotion<LorenzTaylor>{{5}, 0.002}) / error(LorenzMotion<LorenzTaylor>{{5}, 0.001});
  const double fourth =
      error(LorenzMotion<LorenzRungeKutta>{{}, 0.02}) / error(LorenzMotion<LorenzRungeKutta>{{}, 0.01});
  EXPECT_NEAR(taylor, 2.0, 0.2);
  EXPECT_NEAR(fourth, 16.0, 3.0);
}

TEST(Lorenz, CrossesALongGapInPieces) {
  const Vector3d x(3.0, -4.0, 25.0);
  EXPECT_LT((kTaylor.f(x, 0.06) - kTaylor.f(kTaylor.f(kTaylor.f(x, 0.02), 0.02), 0.02)).norm(), 1e-9);
  EXPECT_LT((kRungeKutta.F(x, 0.04) - kRungeKutta.F(kRungeKutta.f(x, 0.02), 0.02) * kRungeKutta.F(x, 0.02)).norm(),
            1e-9);
  EXPECT_TRUE(kTaylor.Q(0.06).isApprox(3.0 * 0.09 * Matrix3d::Identity()));
}

TEST(Lorenz, HasTheJacobianOfCentralDifferences) {
  RandomStream random({22, Role::evaluation, 0}, StreamId::test);
  const Vector3d step = Vector3d::Constant(1e-4);
  const auto check = [&](const auto& motion) {
    const Vector3d x = state(random);
    const double dt_s = random.uniform(0.001, 0.06);
    const Matrix3d expected =
        testing::central_differences([&](const Vector3d& at) { return motion.f(at, dt_s); }, x, step);
    EXPECT_LT((motion.F(x, dt_s) - expected).cwiseAbs().maxCoeff(), kJacobian * (1.0 + expected.norm()));
  };
  for (int trial = 0; trial < 100; ++trial) {
    check(kTaylor);
    check(kRungeKutta);
  }
}

TEST(Lorenz, IsNotFiniteOverAGapThatLeavesNothingKnown) {
  EXPECT_FALSE(kTaylor.f(Vector3d(1.0, 1.0, 1.0), 1e9).allFinite());
  EXPECT_FALSE(kRungeKutta.F(Vector3d(1.0, 1.0, 1.0), 1e9).allFinite());
  EXPECT_TRUE(kRungeKutta.f(Vector3d(1.0, 1.0, 1.0), 50.0).allFinite());
}

}  // namespace
}  // namespace truebearing::lorenz_test
