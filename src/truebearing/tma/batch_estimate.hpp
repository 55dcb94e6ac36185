// SPDX-License-Identifier: Apache-2.0
// What a batch estimator says of a target at constant velocity: its state at the time of the last bearing, and how it
// came to it.
#pragma once

#include <Eigen/Core>

namespace truebearing {

struct BatchEstimate {
  bool found = false;  ///< false where no start ended in finite numbers; nothing below holds then
  double time_s = 0.0;
  Eigen::Vector4d x = Eigen::Vector4d::Zero();  ///< [east, north, v_east, v_north] in m and m/s at time_s
  Eigen::Matrix4d P = Eigen::Matrix4d::Zero();  ///< inverse of the information at the estimate, carried to time_s
  double cost = 0.0;                            ///< 1/2 sum of squared normalised residuals, without a prior's share
  double objective = 0.0;                       ///< with it, of TargetMotionBatch
  int iterations = 0;                           ///< of the start that won
  bool converged = true;                        ///< false where their limit ended it
  int starts = 0;
  int non_finite_starts = 0;
};

/// Inverse of an information matrix that may be singular: in directions of which it says less than a part in 1e12 of
/// what its diagonal says, the variance stops there. Symmetric positive definite for every finite A with a positive
/// diagonal.
Eigen::Matrix4d covariance_of(const Eigen::Matrix4d& information);

/// x and P after t seconds at constant velocity.
void carry(double t, Eigen::Vector4d& x, Eigen::Matrix4d& P);

}  // namespace truebearing
