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
  BoundedMatrix moments;   ///< (n x n), its covariance in standard deviations of P, the lower half; or empty

  /// Makes of P (n x n) the correction's own covariance in the frame, of any units: moments are in standard deviations
  /// of P. sigma_of(): these (n), in the frame, which P itself need not be in; asked for where there are moments.
  template <typename Matrix, typename Sigma>
  void make_own(Matrix& P, const Sigma& sigma_of) const {
    if (moments.size() == 0) {
      P *= inflation;
      return;
    }
    const auto sigma = sigma_of();
    const double* const moment = moments.data();
    const Eigen::Index n = P.rows();
    for (Eigen::Index j = 0; j < n; ++j)
      for (Eigen::Index i = j; i < n; ++i) P(i, j) = P(j, i) = sigma[i] * sigma[j] * moment[i + n * j];
  }
  /// The same of a P that is in the frame.
  BoundedMatrix covariance(const BoundedMatrix& P) const {
    BoundedMatrix own = P;
    make_own(own, [&]() -> BoundedVector { return P.diagonal().cwiseSqrt(); });
    return own;
  }
};

}  // namespace truebearing
