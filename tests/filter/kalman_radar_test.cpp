// SPDX-License-Identifier: Apache-2.0
// The plain filter of the radar problem of Lee et al., in expectation over the measurement noise: with the gains known
// the error obeys e = (I - K H) F e + K v, so that bias and covariance of the error follow exactly, without a draw.
#include <gtest/gtest.h>

#include <cmath>

#include "truebearing/filter/kalman.hpp"
#include "truebearing/measurement/position.hpp"
#include "truebearing/motion/constant_velocity.hpp"

namespace truebearing::kalman_radar_test {
namespace {

TEST(KalmanFilter, PlainRadarFilterHasThePublishedErrors) {
  const Eigen::Matrix2d Q = Eigen::Vector2d(5.0, 0.1).asDiagonal();
  const ConstantVelocity<1, FixedNoise<2>> motion{{Q, 1.0}};
  const Position<1> model{Eigen::Matrix<double, 1, 1>(std::sqrt(1e7))};
  KalmanFilter<2> filter(Eigen::Vector2d::Zero(), 999.0 * Eigen::Matrix2d::Identity());
  Eigen::Vector2d bias(0.0, 200.0);  // truth minus estimate, at k = 0
  Eigen::Matrix2d C = Eigen::Matrix2d::Zero();
  Eigen::Array2d squared = Eigen::Array2d::Zero();
  constexpr int kSteps = 240;
  for (int k = 1; k <= kSteps; ++k) {
    filter.predict(motion, 1.0);
    const auto update = filter.update(model, Eigen::Matrix<double, 1, 1>(0.0));
    const Eigen::Matrix2d A = (Eigen::Matrix2d::Identity() - update.K * model.H(filter.x())) * motion.F(1.0);
    bias = (A * bias).eval();
    C = (A * C * A.transpose() + update.K * model.R() * update.K.transpose()).eval();
    squared += bias.array().square() + C.diagonal().array();
  }
  const Eigen::Array2d rmse = (squared / kSteps).sqrt();
  EXPECT_NEAR(rmse(0), 1343.5, 1e-3 * 1343.5);
  EXPECT_NEAR(rmse(1), 63.73, 1e-3 * 63.73);
}

}  // namespace
}  // namespace truebearing::kalman_radar_test
