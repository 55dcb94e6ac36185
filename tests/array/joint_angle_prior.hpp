// SPDX-License-Identifier: Apache-2.0
// What is believed of three targets before an interval, for tests of the joint angle filter.
#pragma once

#include <cmath>

#include "tests/support/array_scene.hpp"
#include "truebearing/array/joint_angle_filter.hpp"

namespace truebearing::testing {

inline constexpr int kTargets = 3;

// Any covariance of three targets, whose angles depend on their rates and on each other.
inline JointAngleState joint_angle_prior(const ArrayScene& scene, std::uint64_t run = 0,
                                         double angle_sigma_rad = 0.02) {
  RandomStream random({11, Role::evaluation, run}, StreamId::test);
  JointAngleState state;
  state.x.resize(3 * kTargets);
  state.q.setConstant(kTargets, 1e-6);
  state.innovations.setZero(kTargets);
  Eigen::VectorXd sigma(3 * kTargets);
  sigma << Eigen::Vector3d::Constant(angle_sigma_rad), Eigen::Vector3d::Constant(0.5), Eigen::Vector3d::Constant(0.02);
  Eigen::MatrixXd C(3 * kTargets, 3 * kTargets);
  for (double& value : C.reshaped()) value = random.normal() / 3.0;
  const Eigen::MatrixXd correlation = C * C.transpose() + Eigen::MatrixXd::Identity(9, 9);
  state.P = sigma.asDiagonal() * correlation * sigma.asDiagonal();
  for (int n = 0; n < kTargets; ++n) {
    const std::size_t at = static_cast<std::size_t>(n);
    state.x[n] = scene.angles_rad[at] + 0.3 * angle_sigma_rad * random.normal();
    state.x[kTargets + n] = std::log(scene.powers[at]) + 0.3 * random.normal();
    state.x[2 * kTargets + n] = 0.01 * random.normal();
  }
  return state;
}

}  // namespace truebearing::testing
