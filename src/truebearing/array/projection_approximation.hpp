// SPDX-License-Identifier: Apache-2.0
// PAST, projection approximation subspace tracking (Yang 1995, table I): the N columns of W (M x N) span the signal
// subspace, snapshot by snapshot, with what is older weighted down by beta.
//     y = W^H x,  h = P y,  g = h / (beta + y^H h),  P = Tri{P - g h^H} / beta,  W = W + (x - W y) g^H
// Tri: one triangle is computed and the other is its mirror. Without it rounding grows as beta^-t, by 4.7 in an
// interval of 30 snapshots, until P is no covariance any more.
#pragma once

#include <Eigen/Core>

#include "truebearing/array/interval.hpp"
#include "truebearing/array/line_array.hpp"

namespace truebearing {

class ProjectionApproximation {
 public:
  explicit ProjectionApproximation(double beta = 0.95) : beta_(beta) {}

  /// Begins with W = `basis` (M x N) and P = I.
  void begin(const Eigen::MatrixXcd& basis);
  /// Takes the usable snapshots of an interval, of as many sensors. No allocation.
  void update(const Interval& interval);

  /// W. Its rows are padded with zeros to whole registers (simd_width.hpp).
  const SplitMatrix<double>& basis() const { return W_; }

 private:
  double beta_;
  SplitMatrix<double> W_;
  SplitMatrix<double> P_;  // (N x N), Hermitian; rows padded as those of W
  Eigen::MatrixXd work_;   // y, g and h (padded N), real and imaginary parts as columns
};

}  // namespace truebearing
