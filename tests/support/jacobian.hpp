// SPDX-License-Identifier: Apache-2.0
// An independent derivative for tests of Jacobians: central differences.
#pragma once

#include <Eigen/Core>

namespace truebearing::testing {

/// df/dx at x (n): column j is (f(x + step_j) - f(x - step_j)) / 2 step_j.
template <typename Function, int N>
auto central_differences(const Function& f, const Eigen::Matrix<double, N, 1>& x,
                         const Eigen::Matrix<double, N, 1>& step) {
  constexpr int kRows = decltype(f(x))::RowsAtCompileTime;
  Eigen::Matrix<double, kRows, N> jacobian;
  for (int j = 0; j < N; ++j) {
    Eigen::Matrix<double, N, 1> above = x, below = x;
    above(j) += step(j);
    below(j) -= step(j);
    jacobian.col(j) = (f(above) - f(below)) / (above(j) - below(j));
  }
  return jacobian;
}

}  // namespace truebearing::testing
