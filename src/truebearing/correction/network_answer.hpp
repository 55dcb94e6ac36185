// SPDX-License-Identifier: Apache-2.0
// What a network is told at a step of a track, what it may remember of the track, and what it answers.
#pragma once

#include <Eigen/Core>

#include "truebearing/core/bounded.hpp"

namespace truebearing {

inline constexpr int kMaxFeatures = 16;
inline constexpr int kMaxMemory = 128;

using NetworkInputs = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxFeatures, 1>;  ///< (d), in the features' units
using NetworkMemory = Eigen::Matrix<float, Eigen::Dynamic, 1, 0, kMaxMemory, 1>;

struct NetworkAnswer {
  BoundedVector y;         ///< (n), the correction, in the units and the frame of the design
  double inflation = 1.0;  ///< of the covariance P of `covariance_of`, where there are no moments
  BoundedMatrix moments;   ///< (n x n), the correction's covariance in standard deviations of P; or empty

  /// The correction's own covariance, of P (n x n), P and the result both in the frame. Any units: moments are in
  /// standard deviations of P.
  BoundedMatrix covariance(const BoundedMatrix& P) const {
    if (moments.size() == 0) return inflation * P;
    const Eigen::Index n = P.rows();
    const BoundedVector sigma = P.diagonal().cwiseSqrt();
    BoundedMatrix covariance(n, n);
    for (Eigen::Index j = 0; j < n; ++j)
      for (Eigen::Index i = j; i < n; ++i) covariance(i, j) = covariance(j, i) = sigma[i] * sigma[j] * moments(i, j);
    return covariance;
  }
};

}  // namespace truebearing
