// SPDX-License-Identifier: Apache-2.0
#include "truebearing/measurement/position.hpp"

#include <gtest/gtest.h>

namespace truebearing::position_test {
namespace {

TEST(Position, MeasuresThePositions) {
  const Position<2> model{{3.0, 4.0}};
  const Eigen::Vector4d x(10.0, -20.0, 1.0, 2.0);
  EXPECT_EQ(model.h(x), Eigen::Vector2d(10.0, -20.0));
  EXPECT_EQ(model.H(x) * x, model.h(x));
  EXPECT_EQ(model.R(), Eigen::Matrix2d(Eigen::Vector2d(9.0, 16.0).asDiagonal()));
  EXPECT_EQ(model.residual({1.0, 2.0}, {4.0, 1.0}), Eigen::Vector2d(-3.0, 1.0));
}

TEST(Position, HasOneRowInOneDimension) {
  const Position<1> model{Eigen::Matrix<double, 1, 1>(2.0)};
  EXPECT_EQ(model.H({5.0, 6.0}), Eigen::RowVector2d(1.0, 0.0));
  EXPECT_EQ(model.R()(0, 0), 4.0);
}

}  // namespace
}  // namespace truebearing::position_test
