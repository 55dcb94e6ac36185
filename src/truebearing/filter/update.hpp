// SPDX-License-Identifier: Apache-2.0
// What one measurement update leaves behind besides the new state.
#pragma once

#include <Eigen/Core>

#include "truebearing/core/status.hpp"

namespace truebearing {

/// State of n, measurement of m. Where status is `failed`, S, K and nis are what the arithmetic came to and may be NaN.
template <int N, int M, typename Scalar = double>
struct Update {
  Eigen::Matrix<Scalar, M, 1> nu;  ///< innovation, residual(z, h(x_pred)) (m)
  Eigen::Matrix<Scalar, M, M> S;   ///< its covariance, H P H' + R (m x m)
  Eigen::Matrix<Scalar, N, M> K;   ///< gain, P H' S^-1 (n x m)
  Scalar nis;                      ///< nu' S^-1 nu
  StepStatus status;               ///< ok or failed
};

}  // namespace truebearing
