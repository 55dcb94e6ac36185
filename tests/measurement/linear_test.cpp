// SPDX-License-Identifier: Apache-2.0
#include "truebearing/measurement/linear.hpp"

#include <gtest/gtest.h>

namespace truebearing::linear_test {
namespace {

TEST(Linear, IsTheMatrixTimesTheState) {
  Eigen::Matrix<double, 2, 3> H;
  H << 1.0, 2.0, 0.0, 0.0, -1.0, 4.0;
  const Linear<3, 2> model{H, {2.0, 3.0}};
  const Eigen::Vector3d x(5.0, -7.0, 1.0);
  EXPECT_EQ(model.h(x), Eigen::Vector2d(-9.0, 11.0));
  EXPECT_EQ(model.H(x), H);
  EXPECT_EQ(model.R(), Eigen::Matrix2d(Eigen::Vector2d(4.0, 9.0).asDiagonal()));
  EXPECT_EQ(model.residual({6.0, 1.0}, {5.0, -7.0}), Eigen::Vector2d(1.0, 8.0));
}

}  // namespace
}  // namespace truebearing::linear_test
