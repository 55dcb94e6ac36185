// SPDX-License-Identifier: Apache-2.0
#include "truebearing/measurement/bearing_frequency.hpp"

#include <gtest/gtest.h>

#include "tests/support/jacobian.hpp"
#include "truebearing/core/random.hpp"

namespace truebearing::bearing_frequency_test {
namespace {

using State = BearingFrequency<>::State;
using Vector = BearingFrequency<>::Vector;

constexpr double kIdentity = 1e-9;  // relative
constexpr double kJacobian = 1e-6;  // relative

BearingFrequency<> random_sensor(RandomStream& random) {
  return {{random.normal() * 1e3, random.normal() * 1e3}, {4.0 * random.normal(), 4.0 * random.normal()}, 0.02, 0.05};
}

State random_target(RandomStream& random) {
  State x;
  x << random.normal() * 1e4, random.normal() * 1e4, random.normal() * 5.0, random.normal() * 5.0,
      80.0 + 80.0 * random.uniform();
  return x;
}

TEST(BearingFrequency, RisesWhileTheTargetComesCloser) {
  const BearingFrequency<> model{{100.0, 200.0}, {0.0, 3.0}, 0.02, 0.05, 1500.0};
  State x;
  x << 100.0, 5200.0, 4.0, -12.0, 100.0;  // due North, closing at 15 m/s
  EXPECT_DOUBLE_EQ(model.h(x)(0), 0.0);
  EXPECT_DOUBLE_EQ(model.h(x)(1), 101.0);
  EXPECT_DOUBLE_EQ(model.R()(0, 0), 4e-4);
  EXPECT_DOUBLE_EQ(model.R()(1, 1), 2.5e-3);
  EXPECT_EQ(model.R()(0, 1), 0.0);
}

TEST(BearingFrequency, HasTheJacobianOfCentralDifferences) {
  RandomStream random({34, Role::evaluation, 0}, StreamId::test);
  for (int trial = 0; trial < 200; ++trial) {
    const BearingFrequency<> model = random_sensor(random);
    const State x = random_target(random);
    const Vector z = model.h(x);
    const double range_m = (x.head<2>() - model.site_m).norm();
    State step;
    step << 1e-4 * range_m, 1e-4 * range_m, 1e-2, 1e-2, 1e-2;
    const auto from_z = [&](const State& at) { return model.residual(model.h(at), z); };
    const auto expected = testing::central_differences(from_z, x, step);
    for (int row = 0; row < 2; ++row)
      EXPECT_LT((model.H(x).row(row) - expected.row(row)).norm(), kJacobian * expected.row(row).norm()) << row;
    EXPECT_LT((model.H(x).row(1).head<2>() - expected.row(1).head<2>()).norm(),
              1e-4 * expected.row(1).head<2>().norm());
  }
}

TEST(BearingFrequency, HasABearingsRowsWhereOnlyTheBearingIsThere) {
  BearingFrequency<> model{{1.0, 2.0}, {3.0, 4.0}, 0.02, 0.05};
  State x;
  x << 3000.0, -4000.0, 2.0, 1.0, 90.0;
  const BearingFrequency<> whole = model;
  model.has_frequency = false;
  const Vector z(whole.h(x)(0) + 0.1, std::nan(""));
  EXPECT_EQ(model.H(x).row(0), whole.H(x).row(0));
  EXPECT_TRUE(model.H(x).row(1).isZero(0.0));
  EXPECT_NEAR(model.residual(z, model.h(x))(0), 0.1, 1e-12);
  EXPECT_EQ(model.residual(z, model.h(x))(1), 0.0);
  EXPECT_TRUE(model.modified_gain(z, x).row(1).isZero(0.0));
  EXPECT_EQ(model.R()(1, 1), 1.0);

  model.has_frequency = true;
  model.has_bearing = false;
  const Vector f(std::nan(""), 91.0);
  EXPECT_TRUE(model.H(x).row(0).isZero(0.0));
  EXPECT_EQ(model.H(x).row(1), whole.H(x).row(1));
  EXPECT_EQ(model.residual(f, model.h(x))(0), 0.0);
  EXPECT_EQ(model.modified_gain(f, x), model.H(x));
}

TEST(BearingFrequency, WholeTurnsChangeNothing) {
  const BearingFrequency<> model{{0.0, 0.0}, {1.0, 1.0}, 0.1, 0.1};
  State x;
  x << -50.0, -4000.0, 1.0, 2.0, 100.0;
  const Vector z(3.1, 99.0);
  for (const int turns : {-3, -1, 1, 2}) {
    const Vector turned(3.1 + 2 * kPi * turns, 99.0);
    EXPECT_LT((model.residual(turned, model.h(x)) - model.residual(z, model.h(x))).norm(), 1e-12);
    EXPECT_LT((model.modified_gain(turned, x) - model.modified_gain(z, x)).norm(), 1e-12);
  }
}

TEST(BearingFrequency, AtTheSensorKnowsNoDirection) {
  const BearingFrequency<> model{{1.0, 2.0}, {0.0, 0.0}, 0.1, 0.1};
  State x;
  x << 1.0, 2.0, 3.0, 4.0, 100.0;
  BearingFrequency<>::Jacobian expected = BearingFrequency<>::Jacobian::Zero();
  expected(1, 4) = 1.0;
  EXPECT_EQ(model.H(x), expected);
  EXPECT_EQ(model.h(x)(1), 100.0);
}

// The identity of the modified gain, for targets however far apart that are ahead along the measured bearing: the
// bearing's row, and with beta that of the radial velocity.
TEST(BearingFrequency, ModifiedGainGivesTheExactDifferencesOfBearingAndRadialVelocity) {
  RandomStream random({35, Role::evaluation, 0}, StreamId::test);
  int ahead = 0;
  for (int trial = 0; trial < 4000; ++trial) {
    const BearingFrequency<> model = random_sensor(random);
    const State x = random_target(random), x_pred = random_target(random);
    const Vector z = model.h(x), z_pred = model.h(x_pred);
    const double turned = model.residual(z, z_pred)(0);
    if (std::abs(turned) >= kPi / 2) continue;
    ++ahead;
    const auto radial = [&](const State& at) {
      const Eigen::Vector2d u = (at.head<2>() - model.site_m).normalized();
      return u.dot(at.segment<2>(2) - model.site_velocity_mps);
    };
    const auto row = model.radial_row(z(0), x_pred);
    const Eigen::Vector4d d = (x - x_pred).head<4>();
    EXPECT_NEAR(row.bearing.dot(d), turned, kIdentity);
    EXPECT_NEAR(row.radial.dot(d), radial(x) - radial(x_pred), kIdentity * 10.0);
    EXPECT_EQ(model.modified_gain(z, x_pred).row(0).head<4>(), row.bearing);

    // With s = 1 / f0 for the fifth component: f s = 1 - v_r / c, so
    // f - f_pred = (-(v_r - v_r_pred) / c - f (s - s_pred)) / s_pred without any remainder.
    const double s = 1.0 / x(4), s_pred = 1.0 / x_pred(4);
    const double from_period = (-row.radial.dot(d) / model.sound_mps - z(1) * (s - s_pred)) / s_pred;
    EXPECT_NEAR(from_period, z(1) - z_pred(1), kIdentity * z(1));

    // With f0 itself the remainder is the product of the two errors.
    const double remainder = (x(4) - x_pred(4)) * (radial(x) - radial(x_pred)) / model.sound_mps;
    EXPECT_NEAR(model.modified_gain(z, x_pred).row(1).dot(x - x_pred), z(1) - z_pred(1) + remainder, kIdentity * z(1));
  }
  EXPECT_GT(ahead, 1000);
}

TEST(BearingFrequency, ModifiedGainIsTheJacobianWhereThePredictionIsSeenAtTheMeasurement) {
  RandomStream random({36, Role::evaluation, 0}, StreamId::test);
  for (int trial = 0; trial < 100; ++trial) {
    const BearingFrequency<> model = random_sensor(random);
    const State x = random_target(random);
    EXPECT_LT((model.modified_gain(model.h(x), x) - model.H(x)).norm(), kIdentity * model.H(x).norm());
  }
}

}  // namespace
}  // namespace truebearing::bearing_frequency_test
