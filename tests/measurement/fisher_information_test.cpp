// SPDX-License-Identifier: Apache-2.0
#include "truebearing/measurement/fisher_information.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "truebearing/measurement/bearing.hpp"
#include "truebearing/measurement/position.hpp"

namespace truebearing::fisher_information_test {
namespace {

// Two positions a time apart determine position and velocity: the bound is that of two-point differencing.
TEST(FisherInformation, OfTwoPositionsIsTwoPointDifferencing) {
  const Position<1> model{Position<1>::Vector(3.0)};
  const Eigen::Vector2d x(10.0, 2.0);
  Eigen::Matrix2d Phi = Eigen::Matrix2d::Identity();
  Eigen::Matrix2d J = fisher_information(model, x, Phi);
  Phi(0, 1) = 5.0;
  J += fisher_information(model, Eigen::Vector2d(Phi * x), Phi);
  const Eigen::Matrix2d P = J.inverse();
  EXPECT_NEAR(P(0, 0), 9.0, 1e-12);
  EXPECT_NEAR(P(1, 1), 2.0 * 9.0 / 25.0, 1e-12);
  EXPECT_NEAR(P(0, 1), -9.0 / 5.0, 1e-12);
}

TEST(FisherInformation, OfABearingLiesAcrossTheLineOfSight) {
  const Bearing<> model{{0.0, 0.0}, {0.0, 0.0}, 0.02};
  const Eigen::Vector4d x(0.0, 2000.0, 1.0, 1.0);
  const Eigen::Matrix4d J = fisher_information(model, x, Eigen::Matrix4d(Eigen::Matrix4d::Identity()));
  EXPECT_NEAR(J(0, 0), 1.0 / (40.0 * 40.0), 1e-12);
  EXPECT_NEAR(J(1, 1), 0.0, 1e-15);
}

}  // namespace
}  // namespace truebearing::fisher_information_test
