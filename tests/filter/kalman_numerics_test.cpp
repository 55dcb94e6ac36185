// SPDX-License-Identifier: Apache-2.0
// Ill-conditioned problems from the literature: Dyer and McReynolds 1969 (Grewal and Andrews, example 7.2) and Bierman
// 1977.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/filter/linear_model.hpp"
#include "truebearing/core/covariance.hpp"
#include "truebearing/filter/kalman.hpp"

namespace truebearing::kalman_numerics_test {
namespace {

using Vector1d = Eigen::Matrix<double, 1, 1>;

struct Outcome {
  int accurate = 0;  ///< said ok with a relative error of P below 1e-3
  int failed = 0;
  int silent = 0;  ///< said ok with a larger error
};

template <typename Form>
Outcome dyer_mcreynolds() {
  Outcome outcome;
  for (int k = 1; k <= 19; ++k) {
    const double d = std::pow(std::numeric_limits<double>::epsilon(), 2.0 / 3.0) * std::pow(10.0, 10 - k);
    LinearMeasurement<3, 2> model;
    model.jacobian << 1, 1, 1, 1, 1, 1 + d;
    model.noise = d * d * Eigen::Matrix2d::Identity();
    KalmanFilter<3, Form> filter({1.0, 1.0, -1.0}, Eigen::Matrix3d::Identity());
    const auto update = filter.update(model, {1.0, 1.0});
    const double a = 5 + 2 * d * (1 + d), b = -2 - d;
    Eigen::Matrix3d P;
    P << a, -3, b, -3, a, b, b, b, 4 + d * d;
    P /= 8 + 2 * d * (1 + d);
    const bool accurate = (filter.P() - P).norm() < 1e-3 * P.norm();
    if (update.status == StepStatus::failed)
      ++outcome.failed;
    else
      ++(accurate ? outcome.accurate : outcome.silent);
  }
  return outcome;
}

TEST(KalmanFilterNumerics, DefaultFormIsNeverSilentlyWrong) {
  const Outcome outcome = dyer_mcreynolds<Joseph>();
  EXPECT_EQ(outcome.silent, 0);
  EXPECT_GE(outcome.accurate, 5);
}

TEST(KalmanFilterNumerics, SquareRootReachesThirteenOfNineteen) {
  const Outcome outcome = dyer_mcreynolds<SquareRoot>();
  EXPECT_EQ(outcome.accurate, 13);
  EXPECT_EQ(outcome.failed, 6);
  EXPECT_EQ(outcome.silent, 0);
}

template <typename Form>
double bierman_error(double e) {
  KalmanFilter<2, Form> filter(Eigen::Vector2d::Zero(), Eigen::Matrix2d::Identity() / (e * e));
  filter.update(LinearMeasurement<2, 1>{{1.0, e}, Vector1d(1.0)}, Vector1d(0.0));
  filter.update(LinearMeasurement<2, 1>{{1.0, 1.0}, Vector1d(1.0)}, Vector1d(0.0));
  const double determinant = 1 - 2 * e + e * e * (4 + 2 * e * e);
  Eigen::Matrix2d P;
  P << 1 + 2 * e * e, -(1 + e), -(1 + e), 2 + e * e;
  P /= determinant;
  return (filter.P() - P).norm() / P.norm();
}

TEST(KalmanFilterNumerics, SquareRootIsExactOnBiermansExample) {
  for (const double e : {1e-3, 1e-5, 1e-7, 1e-9}) EXPECT_LT(bierman_error<SquareRoot>(e), 4e-15) << "e " << e;
}

TEST(KalmanFilterNumerics, JosephKeepsHalfTheDigitsOnBiermansExampleAndConventionalNone) {
  EXPECT_LT(bierman_error<Joseph>(1e-9), 1e-6);
  EXPECT_GT(bierman_error<Conventional>(1e-9), 1.0);
}

template <typename Form>
void expect_symmetric_growth() {
  LinearMotion<2> motion;
  motion.transition << 1.5, 1.0, 0.0, 1.2;
  motion.noise = 0.01 * Eigen::Matrix2d::Identity();
  const LinearMeasurement<2, 1> model{{1.0, 0.3}, Vector1d(1.0)};
  KalmanFilter<2, Form> filter(Eigen::Vector2d::Zero(), 1e6 * Eigen::Matrix2d::Identity());
  for (int k = 0; k < 100; ++k) {
    ASSERT_EQ(filter.predict(motion, 1.0), StepStatus::ok);
    ASSERT_EQ(filter.update(model, Vector1d(0.0)).status, StepStatus::ok);
    ASSERT_EQ(filter.P()(0, 1), filter.P()(1, 0));
    ASSERT_TRUE(is_covariance(filter.P()));
  }
}

TEST(KalmanFilterNumerics, UnstableMotionKeepsCovarianceSymmetric) {
  expect_symmetric_growth<Joseph>();
  expect_symmetric_growth<SquareRoot>();
}

}  // namespace
}  // namespace truebearing::kalman_numerics_test
