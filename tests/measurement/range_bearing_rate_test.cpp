// SPDX-License-Identifier: Apache-2.0
#include "truebearing/measurement/range_bearing_rate.hpp"

#include <gtest/gtest.h>

#include "tests/support/jacobian.hpp"
#include "truebearing/core/random.hpp"

namespace truebearing::range_bearing_rate_test {
namespace {

constexpr double kAlgebra = 1e-12;
constexpr double kJacobian = 1e-6;

TEST(RangeBearingRate, IsTheSpeedAlongTheSight) {
  const RangeBearingRate<> model{{100.0, 200.0}, {1.0, -2.0}, 50.0, 0.01, 0.5};
  const Eigen::Vector3d z = model.h({103.0, 204.0, 7.0, 8.0});
  EXPECT_NEAR(z(0), 5.0, kAlgebra);
  EXPECT_NEAR(z(1), std::atan2(3.0, 4.0), kAlgebra);
  EXPECT_NEAR(z(2), 0.6 * 6.0 + 0.8 * 10.0, kAlgebra);
  EXPECT_TRUE(model.R().isApprox(Eigen::Matrix3d(Eigen::Vector3d(2500.0, 1e-4, 0.25).asDiagonal()), kAlgebra));
}

TEST(RangeBearingRate, HasTheJacobianOfCentralDifferences) {
  RandomStream random({23, Role::evaluation, 0}, StreamId::test);
  for (int trial = 0; trial < 100; ++trial) {
    const RangeBearingRate<> model{
        {random.normal() * 1e3, random.normal() * 1e3}, {random.normal() * 10, random.normal() * 10}, 1.0, 1.0, 1.0};
    const Eigen::Vector4d x(random.normal() * 1e4, random.normal() * 1e4, random.normal() * 50, random.normal() * 50);
    const Eigen::Vector3d z = model.h(x);
    const double length_m = 1e-4 * z(0);
    const Eigen::Vector4d step(length_m, length_m, 1e-3, 1e-3);
    const auto from_z = [&](const Eigen::Vector4d& at) { return model.residual(model.h(at), z); };
    const Eigen::Matrix<double, 3, 4> expected = testing::central_differences(from_z, x, step);
    for (int i = 0; i < 3; ++i)
      EXPECT_LT((model.H(x).row(i) - expected.row(i)).norm(), kJacobian * expected.row(i).norm()) << i;
  }
}

TEST(RangeBearingRate, SaysNothingAtTheSite) {
  const RangeBearingRate<> model{{1.0, 2.0}, {3.0, 4.0}, 10.0, 0.1, 1.0};
  EXPECT_EQ(model.H({1.0, 2.0, 3.0, 5.0}), (Eigen::Matrix<double, 3, 4>::Zero()));
  EXPECT_EQ(model.h({1.0, 2.0, 3.0, 5.0})(2), 0.0);
}

TEST(RangeBearingRate, WholeTurnsChangeNothing) {
  const RangeBearingRate<> model{{0.0, 0.0}, {0.0, 0.0}, 10.0, 0.1, 1.0};
  const Eigen::Vector3d z(5000.0, 3.1, 7.0), z_pred(4990.0, -3.1, 4.0);
  const Eigen::Vector3d residual = model.residual(z, z_pred);
  EXPECT_NEAR(residual(0), 10.0, kAlgebra);
  EXPECT_NEAR(residual(1), 6.2 - 2 * kPi, kAlgebra);
  EXPECT_NEAR(residual(2), 3.0, kAlgebra);
}

}  // namespace
}  // namespace truebearing::range_bearing_rate_test
