// SPDX-License-Identifier: Apache-2.0
#include "truebearing/array/line_array.hpp"

#include <gtest/gtest.h>

#include "tests/support/array_scene.hpp"

namespace truebearing::line_array_test {
namespace {

constexpr LineArray kArrays[] = {{15, 0.5}, {2, 0.5}, {60, 0.31}};

SplitMatrix<double> zeros(int rows, int columns) {
  SplitMatrix<double> matrix;
  matrix.setZero(rows, columns);
  return matrix;
}

TEST(LineArray, SteeringVectorIsThePhaseAtEachSensor) {
  for (const LineArray& array : kArrays)
    for (double angle_deg = -89.0; angle_deg <= 89.0; angle_deg += 8.9) {
      SplitMatrix<double> a = zeros(array.sensors, 2), b = a;
      array.steer(radians(angle_deg), 1, a, b);
      const Eigen::VectorXcd expected = testing::steering(array, radians(angle_deg));
      EXPECT_LT((testing::joined(a, array.sensors).col(1) - expected).cwiseAbs().maxCoeff(), 1e-12) << angle_deg;
      EXPECT_TRUE(a.re.col(0).isZero(0.0) && b.im.col(0).isZero(0.0));
      EXPECT_NEAR(std::arg(expected[1]), std::remainder(array.phase_step(radians(angle_deg)), 2.0 * kPi), 1e-12);
    }
}

TEST(LineArray, SaysFromWhereAnglesHaveImages) {
  EXPECT_EQ((LineArray{15, 0.5}.note()), "");
  EXPECT_EQ((LineArray{15, 750.0 / 1500.0}.note()), "");
  EXPECT_NE((LineArray{15, 4.0}.note().find("sines differ by 0.25 sound alike, so that only targets within 7.18 deg")),
            std::string::npos);
}

TEST(LineArray, DerivativeOfTheSteeringVectorIsThatOfFiniteDifferences) {
  constexpr double kStep_rad = 1e-6;
  for (const LineArray& array : kArrays)
    for (double angle_deg = -80.0; angle_deg <= 80.0; angle_deg += 16.0) {
      SplitMatrix<double> a = zeros(array.sensors, 1), b = a;
      array.steer(radians(angle_deg), 0, a, b);
      const Eigen::VectorXcd differences = (testing::steering(array, radians(angle_deg) + kStep_rad) -
                                            testing::steering(array, radians(angle_deg) - kStep_rad)) /
                                           (2.0 * kStep_rad);
      EXPECT_LT((testing::joined(b, array.sensors).col(0) - differences).norm(), 1e-6 * differences.norm())
          << angle_deg;
    }
}

TEST(LineArray, LeavesThePaddingAlone) {
  SplitMatrix<double> a = zeros(16, 1), b = a;
  a.re(15, 0) = a.im(15, 0) = b.re(15, 0) = b.im(15, 0) = 7.0;
  LineArray{15, 0.5}.steer(0.3, 0, a, b);
  EXPECT_EQ(a.re(15, 0) + a.im(15, 0) + b.re(15, 0) + b.im(15, 0), 28.0);
}

TEST(LineArray, TargetsOneResolutionApartDoNotDisturbEachOther) {
  for (const LineArray& array : kArrays) {
    const double first = -0.5, second = std::asin(std::sin(first) + array.resolution_sine());
    EXPECT_NEAR(array.distance(first, second), 1.0, 1e-12);
    EXPECT_NEAR(array.distance(second, first), -1.0, 1e-12);
    EXPECT_LT(std::abs(testing::steering(array, first).dot(testing::steering(array, second))), 1e-9);
  }
}

}  // namespace
}  // namespace truebearing::line_array_test
