// SPDX-License-Identifier: Apache-2.0
#include "truebearing/array/beam_power.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/array_scene.hpp"
#include "truebearing/core/angle.hpp"

namespace truebearing::beam_power_test {
namespace {

using testing::scene_of;

TEST(BeamPower, OfOnePlaneWaveIsItsPowerThereAndNothingAtTheNulls) {
  const LineArray array{8, 0.5};
  const double angle_rad = radians(20.0), power = 3.0;
  SplitMatrix<double> a, b;
  a.setZero(8, 1);
  b.setZero(8, 1);
  array.steer(angle_rad, 0, a, b);
  Eigen::VectorXcd wave(8);
  for (int m = 0; m < 8; ++m) wave[m] = {a.re(m, 0), a.im(m, 0)};
  const Eigen::MatrixXcd R = power * wave * wave.adjoint();
  const double null_rad = std::asin(std::sin(angle_rad) + array.resolution_sine());
  const std::vector<double> p = beam_power(array, R, {angle_rad, null_rad, radians(-60.0)});
  EXPECT_NEAR(p[0], power, 1e-12);
  EXPECT_NEAR(p[1], 0.0, 1e-12);
  EXPECT_LT(p[2], 0.1 * power);
}

TEST(BeamPower, PeaksAtTargetsThatABeamTellsApart) {
  const testing::ArrayScene scene = scene_of({-50.0, -20.0, 5.0, 36.0});
  std::vector<double> angles_rad;
  for (int angle_deg = -90; angle_deg <= 90; ++angle_deg) angles_rad.push_back(radians(angle_deg));
  const std::vector<double> p = beam_power(scene.array(), scene.covariance(), angles_rad);
  for (const int target_deg : {-50, -20, 5, 36}) {
    const auto at = static_cast<std::size_t>(target_deg + 90);
    const double around = std::max({p[at - 1], p[at], p[at + 1]});
    EXPECT_GT(around, 2.0 * p[at - 8]) << target_deg;
    EXPECT_GT(around, 2.0 * p[at + 8]) << target_deg;
  }
}

TEST(BeamPower, OfWhiteNoiseIsTheSameEverywhere) {
  for (const double p : beam_power({6, 0.4}, 2.0 * Eigen::MatrixXcd::Identity(6, 6), {-1.0, 0.0, 0.7}))
    EXPECT_NEAR(p, 2.0 / 6.0, 1e-12);
}

}  // namespace
}  // namespace truebearing::beam_power_test
