// SPDX-License-Identifier: Apache-2.0
#include "truebearing/measurement/cartesian_position.hpp"

#include <gtest/gtest.h>

namespace truebearing::cartesian_position_test {
namespace {

TEST(CartesianPosition, MeasuresThePositionsWithTheirFullCovariance) {
  const Eigen::Matrix2d R = (Eigen::Matrix2d() << 9.0, -2.0, -2.0, 16.0).finished();
  const CartesianPosition<2> model{R};
  const Eigen::Vector4d x(10.0, -20.0, 1.0, 2.0);
  EXPECT_EQ(model.h(x), Eigen::Vector2d(10.0, -20.0));
  EXPECT_EQ(model.H(x) * x, model.h(x));
  EXPECT_EQ(model.R(), R);
  EXPECT_EQ(model.residual({1.0, 2.0}, {4.0, 1.0}), Eigen::Vector2d(-3.0, 1.0));
}

}  // namespace
}  // namespace truebearing::cartesian_position_test
