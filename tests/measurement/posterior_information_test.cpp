// SPDX-License-Identifier: Apache-2.0
#include "truebearing/measurement/posterior_information.hpp"

#include <gtest/gtest.h>

#include "truebearing/filter/kalman.hpp"
#include "truebearing/measurement/position.hpp"
#include "truebearing/motion/constant_velocity.hpp"

namespace truebearing::posterior_information_test {
namespace {

using Motion = ConstantVelocity<1, ContinuousWhiteNoise>;
const Position<1> kPosition{Eigen::Matrix<double, 1, 1>(20.0)};
const Eigen::Vector2d kAnywhere(123.0, -4.0);  // the model is linear

TEST(PosteriorInformation, TwoPositionsByHand) {
  const Motion motion{{0.0}};
  PosteriorInformation<2> information;
  EXPECT_FALSE(information.covariance());
  information.update(kPosition, kAnywhere);
  EXPECT_FALSE(information.covariance()) << "one position says nothing of the velocity";
  information.predict(motion.F(5.0), motion.Q(5.0));
  EXPECT_FALSE(information.covariance());
  information.update(kPosition, kAnywhere);
  ASSERT_TRUE(information.covariance());
  Eigen::Matrix2d expected;
  expected << 400.0, 400.0 / 5.0, 400.0 / 5.0, 800.0 / 25.0;
  EXPECT_TRUE(information.covariance()->isApprox(expected, 1e-12)) << *information.covariance();
}

// For a linear model the posterior bound is the covariance of the Kalman filter.
TEST(PosteriorInformation, OfALinearModelIsTheKalmanFilters) {
  const Motion motion{{0.3}};
  const Eigen::Matrix2d P0 = Eigen::Vector2d(900.0, 25.0).asDiagonal();
  KalmanFilter<2> filter(kAnywhere, P0);
  PosteriorInformation<2> information;
  information.add_prior(P0);
  for (int k = 0; k < 40; ++k) {
    const double dt_s = 0.5 + 0.1 * (k % 7);
    filter.predict(motion, dt_s);
    information.predict(motion.F(dt_s), motion.Q(dt_s));
    if (k % 3 == 2) continue;
    filter.update(kPosition, Eigen::Matrix<double, 1, 1>(0.0));
    information.update(kPosition, kAnywhere);
    ASSERT_TRUE(information.covariance());
    EXPECT_TRUE(information.covariance()->isApprox(filter.P(), 1e-10)) << k;
  }
  const Motion other{{0.4}};  // another process noise is seen
  information.predict(other.F(1.0), other.Q(1.0));
  filter.predict(motion, 1.0);
  EXPECT_FALSE(information.covariance()->isApprox(filter.P(), 1e-4));
}

// A bias that the second of two positions has: three unknowns, the last of which joins with its first measurement.
TEST(PosteriorInformation, ParametersJoinAsTheyAreMet) {
  const Motion motion{{0.0}};
  Eigen::Matrix<double, 2, Eigen::Dynamic> biased(2, 3);
  biased << 1.0, 0.0, 1.0, 0.0, 1.0, 0.0;
  PosteriorInformation<Eigen::Dynamic> information(2);
  information.add_prior(Eigen::Vector2d(100.0, 4.0).asDiagonal().toDenseMatrix());
  const Eigen::MatrixXd before = *information.covariance();
  information.add_parameter();
  EXPECT_FALSE(information.covariance()) << "nothing is known of the bias";
  information.update(kPosition, kAnywhere, biased);
  ASSERT_TRUE(information.covariance());
  EXPECT_TRUE(information.covariance()->topLeftCorner(2, 2).isApprox(before, 1e-12))
      << "a position that is off by an unknown bias says nothing of the state";
  EXPECT_NEAR((*information.covariance())(2, 2), 100.0 + 400.0, 1e-9);

  Eigen::Matrix3d F = Eigen::Matrix3d::Identity();
  F.topLeftCorner<2, 2>() = motion.F(5.0);
  const Eigen::MatrixXd expected = F * *information.covariance() * F.transpose();
  information.predict(F, Eigen::Matrix3d::Zero());
  EXPECT_TRUE(information.covariance()->isApprox(expected, 1e-12));
}

}  // namespace
}  // namespace truebearing::posterior_information_test
