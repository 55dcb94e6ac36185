// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/target_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "truebearing/core/angle.hpp"
#include "truebearing/core/random.hpp"

namespace truebearing::target_motion_test {
namespace {

const SensorState kOwnShip{{1000.0, 2000.0}, {3.0, 0.0}};

TEST(TargetMotion, ErrorsByHand) {
  const Eigen::Vector4d truth(4000.0, 6000.0, 3.0, 4.0);      // 5000 m from own ship, at 5 m/s
  const Eigen::Vector4d estimate(4600.0, 6800.0, 0.0, -6.0);  // 6000 m, 6 m/s, course 180
  const TargetMotionError error = target_motion_error(truth, estimate, kOwnShip);
  EXPECT_NEAR(error.range_percent, 20.0, 1e-12);
  EXPECT_NEAR(error.course_deg, 180.0 - degrees(std::atan2(3.0, 4.0)), 1e-12);
  EXPECT_NEAR(error.speed_mps, 1.0, 1e-12);
  const TargetMotionError none = target_motion_error(truth, truth, kOwnShip);
  EXPECT_NEAR(none.range_percent, 0.0, 1e-12);
  EXPECT_EQ(none.course_deg, 0.0);
  EXPECT_EQ(none.speed_mps, 0.0);
}

TEST(TargetMotion, CoursesOnEitherSideOfSouthAreClose) {
  const double a = radians(179.0), b = radians(-179.0);
  const Eigen::Vector4d truth(0.0, 0.0, std::sin(a), std::cos(a)), estimate(0.0, 0.0, std::sin(b), std::cos(b));
  EXPECT_NEAR(target_motion_error(truth, estimate, kOwnShip).course_deg, 2.0, 1e-9);
  EXPECT_NEAR(target_motion_error(estimate, truth, kOwnShip).course_deg, -2.0, 1e-9);
}

TEST(TargetMotion, VarianceIsThatOfSmallErrors) {
  const Eigen::Vector4d truth(4000.0, 6000.0, 3.0, -4.0);
  Eigen::Matrix4d L;
  L << 10.0, 0.0, 0.0, 0.0, -4.0, 5.0, 0.0, 0.0, 0.01, 0.02, 0.02, 0.0, -0.01, 0.0, 0.01, 0.01;
  const TargetMotionVariance variance = target_motion_variance(truth, L * L.transpose(), kOwnShip);
  RandomStream random({}, StreamId::test);
  constexpr int kDraws = 20000;
  TargetMotionVariance drawn{0.0, 0.0, 0.0, 0.0, 0.0};
  for (int i = 0; i < kDraws; ++i) {
    const Eigen::Vector4d d = L * Eigen::Vector4d::NullaryExpr([&] { return random.normal(); });
    const TargetMotionError error = target_motion_error(truth, truth + d, kOwnShip);
    drawn.position_m2 += d.head<2>().squaredNorm() / kDraws;
    drawn.velocity_m2ps2 += d.tail<2>().squaredNorm() / kDraws;
    drawn.range_percent2 += error.range_percent * error.range_percent / kDraws;
    drawn.course_deg2 += error.course_deg * error.course_deg / kDraws;
    drawn.speed_m2ps2 += error.speed_mps * error.speed_mps / kDraws;
  }
  // Four standard errors of a variance of so many draws.
  const double tolerance = 4.0 * std::sqrt(2.0 / kDraws);
  for (const auto part :
       {&TargetMotionVariance::position_m2, &TargetMotionVariance::velocity_m2ps2,
        &TargetMotionVariance::range_percent2, &TargetMotionVariance::course_deg2, &TargetMotionVariance::speed_m2ps2})
    EXPECT_NEAR(drawn.*part / (variance.*part), 1.0, tolerance);
}

}  // namespace
}  // namespace truebearing::target_motion_test
