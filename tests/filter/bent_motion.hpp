// SPDX-License-Identifier: Apache-2.0
// A nonlinear motion of four states that no model of the library has.
#pragma once

#include <Eigen/Core>

#include "truebearing/motion/motion_model.hpp"

namespace truebearing::testing {

// Of a target that turns as its own position says: F and f are nonlinear.
struct Bent {
  using Scalar = double;
  static constexpr int kStates = 4;
  using State = Eigen::Vector4d;
  using Matrix = Eigen::Matrix4d;
  Eigen::Vector4d f(const State& x, double dt_s) const {
    State moved = x;
    moved.head<2>() += dt_s * x.tail<2>();
    moved[2] += 1e-6 * dt_s * x[0] * x[3];
    return moved;
  }
  Matrix F(const State& x, double dt_s) const {
    Matrix jacobian = Matrix::Identity();
    jacobian(0, 2) = jacobian(1, 3) = dt_s;
    jacobian(2, 0) = 1e-6 * dt_s * x[3];
    jacobian(2, 3) = 1e-6 * dt_s * x[0];
    return jacobian;
  }
  Matrix Q(double dt_s) const { return dt_s * Matrix::Identity(); }
};
static_assert(NonlinearMotionModel<Bent>);

}  // namespace truebearing::testing
