// SPDX-License-Identifier: Apache-2.0
#include "truebearing/recording/velocity_truth.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "truebearing/core/constants.hpp"

namespace truebearing::velocity_truth_test {
namespace {

using Values = std::vector<double>;

TEST(VelocityTruth, LineHasItsSlopeAtUnevenTimes) {
  const Values t{1e6, 1e6 + 1.0, 1e6 + 5.0, 1e6 + 5.5, 1e6 + 20.0, 1e6 + 21.0};
  Values p;
  for (const double time_s : t) p.push_back(3.0 - 7.5 * time_s);
  for (const double v : velocity_truth(t, p)) EXPECT_NEAR(v, -7.5, 1e-7);
}

TEST(VelocityTruth, UsesTwoNeighboursOnEitherSide) {
  const Values t{0, 1, 2, 3, 4, 5, 6};
  const Values v = velocity_truth(t, Values{0, 0, 0, 10, 0, 0, 0});
  // Least-squares slopes: sum((t - mean) p) / sum((t - mean)^2), by hand.
  EXPECT_NEAR(v[0], 0.0, 1e-12);
  EXPECT_NEAR(v[1], 1.5 * 10.0 / 5.0, 1e-12);
  EXPECT_NEAR(v[2], 1.0 * 10.0 / 10.0, 1e-12);
  EXPECT_NEAR(v[3], 0.0, 1e-12);
  EXPECT_NEAR(v[4], -1.0 * 10.0 / 10.0, 1e-12);
  EXPECT_NEAR(v[5], -1.5 * 10.0 / 5.0, 1e-12);
  EXPECT_NEAR(v[6], 0.0, 1e-12);
}

TEST(VelocityTruth, MissingPositionsAreLeftOut) {
  const Values v = velocity_truth(Values{0, 1, 2, 3}, Values{0, kNaN, 4, 6});
  EXPECT_NEAR(v[0], 2.0, 1e-12);
  EXPECT_TRUE(std::isnan(v[1]));
  EXPECT_NEAR(v[2], 2.0, 1e-12);
}

TEST(VelocityTruth, OneTimeGivesNoVelocity) {
  EXPECT_TRUE(std::isnan(velocity_truth(Values{1.0}, Values{2.0})[0]));
  EXPECT_TRUE(std::isnan(velocity_truth(Values{0.1, 0.1, 0.1}, Values{2.0, 3.0, 4.0})[1]));
  EXPECT_TRUE(velocity_truth({}, {}).empty());
}

TEST(VelocityTruth, CompletesOnlyTheVelocitiesThatAreNotGiven) {
  const std::vector<double> time_s{0.0, 1.0, 2.0};
  std::vector<BoundedVector> x;
  for (const double t : time_s) x.emplace_back(Eigen::Vector4d(3.0 * t, -2.0 * t, 50.0, 50.0));
  complete_velocities(plane_space(), {true, true, false, true}, time_s, x);
  EXPECT_NEAR(x[1](2), 3.0, 1e-12);
  EXPECT_EQ(x[1](3), 50.0);
  std::vector<BoundedVector> line{Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(4.0, 0.0), Eigen::Vector2d(8.0, 0.0)};
  complete_velocities(line_space(), {true, false}, time_s, line);
  EXPECT_NEAR(line[0](1), 4.0, 1e-12);
}

}  // namespace
}  // namespace truebearing::velocity_truth_test
