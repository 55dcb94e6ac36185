// SPDX-License-Identifier: Apache-2.0
// One orthogonal iteration per interval: W <- orthonormal basis of R W, with R the sample covariance of the interval's
// snapshots (Golub and Van Loan, section 8.2.4). Begun with the span of the interval before it follows the subspace
// without looking at anything older.
#pragma once

#include <Eigen/Core>

#include "truebearing/array/interval.hpp"
#include "truebearing/array/line_array.hpp"

namespace truebearing {

class OrthogonalIteration {
 public:
  /// Begins with the columns of `basis` (M x N).
  void begin(const Eigen::MatrixXcd& basis);
  /// Takes an interval of as many sensors. No allocation.
  void update(const Interval& interval);
  const SplitMatrix<double>& basis() const { return W_; }

 private:
  void orthonormalise();
  SplitMatrix<double> W_, next_;
};

}  // namespace truebearing
