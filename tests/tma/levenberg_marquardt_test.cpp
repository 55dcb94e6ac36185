// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tma/levenberg_marquardt.hpp"

#include <gtest/gtest.h>

namespace truebearing::levenberg_marquardt_test {
namespace {

// Rosenbrock 1960 as least squares: residuals 10 (y - x^2) and 1 - x.
NormalEquations<2> rosenbrock(const Eigen::Vector2d& x) {
  const Eigen::Vector2d r(-10.0 * (x[1] - x[0] * x[0]), -(1.0 - x[0]));  // z - h
  Eigen::Matrix2d J;
  J << -20.0 * x[0], 10.0, -1.0, 0.0;
  return {0.5 * r.squaredNorm(), J.transpose() * r, J.transpose() * J};
}

TEST(LevenbergMarquardt, FollowsRosenbrocksValley) {
  const Minimum<2> minimum = levenberg_marquardt(rosenbrock, Eigen::Vector2d(-1.2, 1.0));
  EXPECT_EQ(minimum.convergence, Convergence::converged);
  EXPECT_LT((minimum.x - Eigen::Vector2d(1.0, 1.0)).norm(), 1e-4);
  EXPECT_LT(minimum.at.cost, 1e-9);
}

TEST(LevenbergMarquardt, StaysAboveItsBoundAndGoesOnInTheOthers) {
  LevenbergMarquardtOptions<2> options;
  options.lower = Eigen::Vector2d(1.5, -1e9);
  const Minimum<2> minimum = levenberg_marquardt(rosenbrock, Eigen::Vector2d(3.0, 1.0), options);
  EXPECT_EQ(minimum.x[0], 1.5);
  EXPECT_NEAR(minimum.x[1], 2.25, 1e-4);
  EXPECT_EQ(minimum.convergence, Convergence::converged);
}

TEST(LevenbergMarquardt, NeverEndsAboveItsStart) {
  for (int k = 0; k < 100; ++k) {
    const Eigen::Vector2d start(0.1 * k - 5.0, 3.0 - 0.07 * k);
    LevenbergMarquardtOptions<2> options;
    options.max_iterations = 3;
    const Minimum<2> minimum = levenberg_marquardt(rosenbrock, start, options);
    EXPECT_LE(minimum.at.cost, rosenbrock(start).cost);
    EXPECT_LE(minimum.iterations, 3);
  }
}

TEST(LevenbergMarquardt, SaysWhereItRanOutOfSteps) {
  LevenbergMarquardtOptions<2> options;
  options.max_iterations = 2;
  EXPECT_EQ(levenberg_marquardt(rosenbrock, Eigen::Vector2d(-1.2, 1.0), options).convergence,
            Convergence::out_of_iterations);
}

TEST(LevenbergMarquardt, StepsBackFromWhereTheProblemHasNoValue) {
  // Finite for x > 0 only: sqrt(x) = 0.1 from x = 4, where the first full step leads to a negative x.
  const auto problem = [](const Eigen::Matrix<double, 1, 1>& x) {
    const double root = std::sqrt(x[0]), r = 0.1 - root, j = 0.5 / root;
    return NormalEquations<1>{0.5 * r * r, Eigen::Matrix<double, 1, 1>(j * r), Eigen::Matrix<double, 1, 1>(j * j)};
  };
  const Minimum<1> minimum = levenberg_marquardt(problem, Eigen::Matrix<double, 1, 1>(4.0));
  EXPECT_NEAR(minimum.x[0], 0.01, 1e-5);
  const auto nowhere = levenberg_marquardt(problem, Eigen::Matrix<double, 1, 1>(-1.0));
  EXPECT_EQ(nowhere.convergence, Convergence::not_finite);
}

TEST(LevenbergMarquardt, LeavesAloneWhatTheDataSayNothingOf) {
  const auto problem = [](const Eigen::Vector2d& x) {
    NormalEquations<2> at;
    at.cost = 0.5 * (x[0] - 3.0) * (x[0] - 3.0);
    at.gradient[0] = 3.0 - x[0];
    at.A(0, 0) = 1.0;
    return at;
  };
  const Minimum<2> minimum = levenberg_marquardt(problem, Eigen::Vector2d(0.0, 7.0));
  EXPECT_NEAR(minimum.x[0], 3.0, 1e-4);
  EXPECT_EQ(minimum.x[1], 7.0);
}

}  // namespace
}  // namespace truebearing::levenberg_marquardt_test
