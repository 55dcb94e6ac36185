// SPDX-License-Identifier: Apache-2.0
// Weighted least squares around a point x (n): residuals r = z - h(x), Jacobian J = dh/dx, weights W. What every step
// of Gauss-Newton and Levenberg-Marquardt is made of, and the Fisher information at the end.
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace truebearing {

template <int N>
struct NormalEquations {
  double cost = 0.0;                                                           ///< F = 1/2 r' W r
  Eigen::Matrix<double, N, 1> gradient = Eigen::Matrix<double, N, 1>::Zero();  ///< J' W r = -grad F
  Eigen::Matrix<double, N, N> A = Eigen::Matrix<double, N, N>::Zero();         ///< J' W J

  bool is_finite() const { return std::isfinite(cost) && gradient.allFinite() && A.allFinite(); }
};

}  // namespace truebearing
