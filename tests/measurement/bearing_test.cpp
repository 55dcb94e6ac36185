// SPDX-License-Identifier: Apache-2.0
#include "truebearing/measurement/bearing.hpp"

#include <gtest/gtest.h>

#include "tests/support/jacobian.hpp"
#include "truebearing/core/random.hpp"

namespace truebearing::bearing_test {
namespace {

constexpr double kAlgebra = 1e-12;
constexpr double kJacobian = 1e-6;

using Vector1 = Bearing<>::Vector;

Bearing<> random_sensor(RandomStream& random) {
  return {{random.normal() * 1e3, random.normal() * 1e3}, {random.normal(), random.normal()}, 0.02};
}

Eigen::Vector4d random_target(RandomStream& random) {
  return {random.normal() * 1e4, random.normal() * 1e4, random.normal() * 5.0, random.normal() * 5.0};
}

TEST(Bearing, IsClockwiseFromNorthAsTheSensorSeesIt) {
  const Bearing<> model{{100.0, 200.0}, {3.0, 4.0}, 0.02};
  EXPECT_NEAR(model.h({103.0, 204.0, 7.0, 8.0})(0), std::atan2(3.0, 4.0), kAlgebra);
  EXPECT_NEAR(model.h({103.0, 200.0, 7.0, 8.0})(0), kPi / 2, kAlgebra);
  EXPECT_NEAR(model.R()(0), 4e-4, kAlgebra);
}

TEST(Bearing, HasTheJacobianOfCentralDifferences) {
  RandomStream random({31, Role::evaluation, 0}, StreamId::test);
  for (int trial = 0; trial < 100; ++trial) {
    const Bearing<> model = random_sensor(random);
    const Eigen::Vector4d x = random_target(random);
    const Vector1 z = model.h(x);
    const double range_m = (x.head<2>() - model.site_m).norm();
    const auto from_z = [&](const Eigen::Vector4d& at) { return model.residual(model.h(at), z); };
    const auto expected = testing::central_differences(from_z, x, Eigen::Vector4d::Constant(1e-4 * range_m).eval());
    EXPECT_LT((model.H(x) - expected).norm(), kJacobian * expected.norm());
  }
}

TEST(Bearing, WholeTurnsChangeNothing) {
  const Bearing<> model{{0.0, 0.0}, {0.0, 0.0}, 0.1};
  const Eigen::Vector4d x(-50.0, -4000.0, 1.0, 2.0);
  const Vector1 z(3.1), z_pred(-3.1);
  EXPECT_NEAR(model.residual(z, z_pred)(0), 6.2 - 2 * kPi, kAlgebra);
  for (const int turns : {-3, -1, 1, 2}) {
    const Vector1 turned(3.1 + 2 * kPi * turns);
    EXPECT_NEAR(model.residual(turned, z_pred)(0), 6.2 - 2 * kPi, kAlgebra);
    EXPECT_LT((model.modified_gain(turned, x) - model.modified_gain(z, x)).norm(), kAlgebra);
  }
}

TEST(Bearing, HasNoDirectionAtTheSensor) {
  const Bearing<> model{{1.0, 2.0}, {0.0, 0.0}, 0.1};
  EXPECT_EQ(model.H({1.0, 2.0, 3.0, 4.0}), Eigen::RowVector4d::Zero());
  EXPECT_EQ(model.modified_gain(Vector1(0.3), {1.0, 2.0, 3.0, 4.0}), Eigen::RowVector4d::Zero());
}

// h(x) - h(x_pred) = g(z, x_pred) (x - x_pred) where z = h(x), however far apart the two are.
TEST(Bearing, ModifiedGainIsTheExactDifferenceWhereTheBearingIsTrue) {
  RandomStream random({32, Role::evaluation, 0}, StreamId::test);
  int ahead = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const Bearing<> model = random_sensor(random);
    const Eigen::Vector4d x = random_target(random), x_pred = random_target(random);
    const Vector1 z = model.h(x), difference = model.residual(z, model.h(x_pred));
    const Eigen::RowVector4d g = model.modified_gain(z, x_pred);
    if (std::abs(difference(0)) >= kPi / 2) {  // x_pred lies behind
      EXPECT_EQ(g, model.H(x_pred));
      continue;
    }
    ++ahead;
    EXPECT_NEAR(g.dot(x - x_pred), difference(0), 1e-11);
  }
  EXPECT_GT(ahead, 500);
}

TEST(Bearing, ModifiedGainIsTheJacobianWhereThePredictionIsSeenAtTheMeasurement) {
  RandomStream random({33, Role::evaluation, 0}, StreamId::test);
  for (int trial = 0; trial < 100; ++trial) {
    const Bearing<> model = random_sensor(random);
    const Eigen::Vector4d x = random_target(random);
    EXPECT_LT((model.modified_gain(model.h(x), x) - model.H(x)).norm(), 1e-9 * model.H(x).norm());
  }
}

}  // namespace
}  // namespace truebearing::bearing_test
