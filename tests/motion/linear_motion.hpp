// SPDX-License-Identifier: Apache-2.0
// What every linear motion model must do, for tests.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>

#include "truebearing/core/covariance.hpp"
#include "truebearing/motion/motion_model.hpp"

namespace truebearing::testing {

/// Largest difference of two covariances, each entry relative to the standard deviations that B gives its components.
template <typename Matrix>
double scaled_difference(const Matrix& A, const Matrix& B) {
  const Matrix scale = (B.diagonal() * B.diagonal().transpose()).cwiseSqrt();
  return (A - B).cwiseAbs().cwiseQuotient(scale).maxCoeff();
}

/// Nothing over no time, a transition over parts that equals the one over the whole, and a Q that is a covariance.
template <LinearMotionModel Motion>
void expect_linear_motion(const Motion& motion) {
  using Matrix = Eigen::Matrix<double, Motion::kStates, Motion::kStates>;
  EXPECT_EQ(motion.F(0.0), Matrix::Identity());
  EXPECT_EQ(motion.Q(0.0), Matrix::Zero());
  for (const double dt_s : {1e-6, 1e-3, 0.1, 1.0, 7.0, 100.0}) {
    EXPECT_TRUE((motion.F(dt_s) * motion.F(0.6 * dt_s)).isApprox(motion.F(1.6 * dt_s), 1e-12)) << "dt " << dt_s;
    EXPECT_TRUE(is_covariance(motion.Q(dt_s), 1e-12)) << "dt " << dt_s;
  }
}

/// Of models that are exact in continuous time: the noise of two parts is that of the whole.
template <LinearMotionModel Motion>
void expect_noise_of_parts_is_that_of_the_whole(const Motion& motion, double a_s, double b_s, double tolerance) {
  using Matrix = Eigen::Matrix<double, Motion::kStates, Motion::kStates>;
  const Matrix parts = motion.F(b_s) * motion.Q(a_s) * motion.F(b_s).transpose() + motion.Q(b_s);
  EXPECT_LT(scaled_difference<Matrix>(parts, motion.Q(a_s + b_s)), tolerance) << a_s << " and " << b_s;
}

}  // namespace truebearing::testing
