// SPDX-License-Identifier: Apache-2.0
#include "truebearing/measurement/position_velocity.hpp"

#include <gtest/gtest.h>

namespace truebearing::position_velocity_test {
namespace {

TEST(PositionVelocity, IsTheStateItself) {
  const PositionVelocity<> model{{2.0, 3.0}};
  const Eigen::Vector2d x(5.0, -7.0);
  EXPECT_EQ(model.h(x), x);
  EXPECT_EQ(model.H(x), Eigen::Matrix2d::Identity());
  EXPECT_EQ(model.R(), Eigen::Matrix2d(Eigen::Vector2d(4.0, 9.0).asDiagonal()));
  EXPECT_EQ(model.residual({6.0, 1.0}, x), Eigen::Vector2d(1.0, 8.0));
}

}  // namespace
}  // namespace truebearing::position_velocity_test
