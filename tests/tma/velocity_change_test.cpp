// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tma/velocity_change.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/bearing_frequency_runs.hpp"
#include "tests/support/bearing_runs.hpp"
#include "truebearing/tma/target_motion_batch.hpp"

namespace truebearing::velocity_change_test {
namespace {

using testing::two_legs;

const Eigen::Vector4d kTarget(3000.0, 5000.0, -2.0, 1.0);

// Exact bearings of a target that changes its velocity; own ship on two legs.
BearingWindow exact(const Eigen::Vector2d& change_mps, double change_s) {
  const BearingWindow straight = two_legs(kTarget, 300.0, 1200.0);
  BearingWindow window;
  for (std::size_t i = 0; i < straight.size(); ++i) {
    const double t = straight.time_s(i);
    const Eigen::Vector2d d =
        kTarget.head<2>() + t * kTarget.tail<2>() + std::max(t - change_s, 0.0) * change_mps - straight.site_m(i);
    window.add(t, std::atan2(d.x(), d.y()), radians(1.0), straight.site_m(i));
  }
  return window;
}

TEST(VelocityChange, OfExactBearingsIsFoundExactly) {
  const Eigen::Vector2d change_mps(5.0, -3.0);
  const BearingWindow window = exact(change_mps, 700.0);
  TargetMotionBatch batch;
  VelocityChangeScan scan(window, nullptr, batch.solve(window));
  const VelocityChange change = scan.fit();
  EXPECT_EQ(change.time_s, 700.0);
  EXPECT_LT(change.cost, 1e-3);
  EXPECT_LT((change.change_mps - change_mps).norm(), 0.1);
  EXPECT_LE(change.earliest_s, 700.0);
  EXPECT_GE(change.latest_s, 700.0);
  Eigen::Vector4d expected = kTarget;
  expected.head<2>() += 1200.0 * kTarget.tail<2>() + 500.0 * change_mps;
  expected.tail<2>() += change_mps;
  EXPECT_LT((change.x - expected).head<2>().norm(), 50.0);
}

// The derivatives that score and fit are made from, against differences.
TEST(MotionRows, DerivativesAreThoseOfTheResiduals) {
  const auto [bearings, frequencies] = testing::KimSong::windows(3);
  MotionRows rows(bearings, &frequencies), moved(bearings, &frequencies);
  Eigen::Vector4d x = testing::KimSong::target(0.0);
  x.head<2>() += rows.polar().origin_s() * x.tail<2>();
  const Eigen::Vector4d y = rows.polar().from_cartesian(x);
  const Eigen::Vector2d dv(0.3, -0.2);
  constexpr double kChange_s = 500.0;
  rows.look_at(y, dv, kChange_s);
  for (int i = 0; i < 6; ++i) {
    const double step = i < 4 ? 1e-6 * std::max(std::abs(y[i]), 1e-5) : 1e-5;
    Eigen::Matrix<double, 6, 1> by = Eigen::Matrix<double, 6, 1>::Zero();
    by[i] = step;
    moved.look_at(y + by.head<4>(), dv + by.tail<2>(), kChange_s);
    // The f0 follows: what it takes is no part of a row, and so only bearings are compared one by one.
    for (std::size_t k = 0; k < bearings.size(); ++k) {
      const MotionRow& row = rows.bearings()[k];
      const double expected = (row.residual - moved.bearings()[k].residual) / step;
      const double derivative = i < 4 ? row.of_y[i] : row.of_change(kChange_s)[i - 4];
      EXPECT_NEAR(derivative, expected, 1e-4 * std::abs(expected) + 1e-6 / step * 1e-6) << i << " " << k;
    }
  }
  // Of both: the gradient of the cost.
  const NormalEquations<6> equations = rows.equations(kChange_s);
  for (int i = 0; i < 6; ++i) {
    const double step = i < 4 ? 1e-5 * std::max(std::abs(y[i]), 1e-5) : 1e-4;
    double costs[2];
    for (const int side : {0, 1}) {
      Eigen::Matrix<double, 6, 1> by = Eigen::Matrix<double, 6, 1>::Zero();
      by[i] = side == 0 ? -step : step;
      moved.look_at(y + by.head<4>(), dv + by.tail<2>(), kChange_s);
      costs[side] = moved.equations(kChange_s).cost;
    }
    const double expected = (costs[0] - costs[1]) / (2.0 * step);
    EXPECT_NEAR(equations.gradient[i], expected, 1e-4 * std::abs(expected) + 1e-2) << i;
  }
}

}  // namespace
}  // namespace truebearing::velocity_change_test
