// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tma/bearing_window.hpp"

#include <gtest/gtest.h>

#include "tests/support/bearing_runs.hpp"
#include "tests/support/jacobian.hpp"

namespace truebearing::bearing_window_test {
namespace {

using testing::two_legs;

constexpr double kJacobian = 1e-6, kAlgebra = 1e-12;
const Eigen::Vector4d kTarget(3000.0, 5000.0, -2.0, 1.0);

TEST(BearingWindow, CostIsThatOfEachResidual) {
  const BearingWindow window = two_legs(kTarget, 300.0, 600.0, 1.0);
  const Eigen::Vector4d x = kTarget + Eigen::Vector4d(200.0, -300.0, 0.5, 0.2);
  double cost = 0.0;
  Eigen::Vector4d gradient = Eigen::Vector4d::Zero();
  Eigen::Matrix4d A = Eigen::Matrix4d::Zero();
  for (std::size_t i = 0; i < window.size(); ++i) {
    const double r = window.residual(i, x, 50.0), w = window.weight(i);
    const Eigen::RowVector4d J = window.jacobian(i, x, 50.0);
    cost += 0.5 * w * r * r;
    gradient += w * r * J.transpose();
    A += w * J.transpose() * J;
  }
  const NormalEquations<4> sums = window.cartesian(x, 50.0);
  EXPECT_NEAR(sums.cost, cost, kAlgebra * cost);
  EXPECT_LT((sums.gradient - gradient).norm(), kAlgebra * gradient.norm());
  EXPECT_LT((sums.A - A).norm(), kAlgebra * A.norm());
}

TEST(BearingWindow, JacobianIsTheDerivativeOfTheBearing) {
  const BearingWindow window = two_legs(kTarget, 300.0, 600.0);
  const auto bearing = [&](const Eigen::Vector4d& x) {
    return Eigen::Matrix<double, 1, 1>(-window.residual(20, x, 100.0));
  };
  const Eigen::Matrix<double, 1, 4> expected =
      testing::central_differences(bearing, kTarget, Eigen::Vector4d(0.1, 0.1, 1e-3, 1e-3));
  EXPECT_LT((window.jacobian(20, kTarget, 100.0) - expected).norm(), kJacobian * expected.norm());
}

TEST(BearingWindow, WholeTurnsChangeNothing) {
  BearingWindow plain, turned;
  const BearingWindow window = two_legs(kTarget, 300.0, 600.0, 1.0);
  for (std::size_t i = 0; i < window.size(); ++i) {
    const double turns = static_cast<double>(static_cast<int>(i) % 5 - 2);
    plain.add(window.time_s(i), window.bearing_rad(i), 0.02, window.site_m(i));
    turned.add(window.time_s(i), window.bearing_rad(i) + turns * 2.0 * kPi, 0.02, window.site_m(i));
  }
  EXPECT_NEAR(plain.cartesian(kTarget, 0.0).cost, turned.cartesian(kTarget, 0.0).cost, 1e-9);
  EXPECT_NEAR(plain.residual(7, kTarget, 0.0), turned.residual(7, kTarget, 0.0), 1e-12);
}

TEST(BearingWindow, DropsWhatIsOlder) {
  BearingWindow window = two_legs(kTarget, 300.0, 600.0);
  window.drop_before(200.0);
  EXPECT_EQ(window.size(), 41u);
  EXPECT_EQ(window.first_time_s(), 200.0);
  EXPECT_EQ(window.site_m(0).y(), 1000.0);
}

TEST(BearingWindow, TargetAtTheSensorIsNotFinite) {
  BearingWindow window;
  window.add(0.0, 1.0, 0.02, {100.0, 200.0});
  EXPECT_FALSE(window.cartesian({100.0, 200.0, 0.0, 0.0}, 0.0).is_finite());
}

}  // namespace
}  // namespace truebearing::bearing_window_test
