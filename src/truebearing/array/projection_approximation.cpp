// SPDX-License-Identifier: Apache-2.0
#include "truebearing/array/projection_approximation.hpp"

#include "truebearing/array/past_kernel.hpp"

namespace truebearing {
void ProjectionApproximation::begin(const Eigen::MatrixXcd& basis) {
  const Eigen::Index M = basis.rows(), padded = padded_to_widest(static_cast<int>(M)), N = basis.cols();
  W_.setZero(padded, N);
  W_.re.topRows(M) = basis.real();
  W_.im.topRows(M) = basis.imag();
  const Eigen::Index padded_columns = padded_to_widest(static_cast<int>(N));
  P_.re.setIdentity(padded_columns, N);
  P_.im.setZero(padded_columns, N);
  work_.setZero(padded_columns, 6);
}

void ProjectionApproximation::update(const Interval& interval) {
  const auto work = [&](Eigen::Index column) { return work_.col(column).data(); };
  kernels::past({static_cast<int>(W_.rows()), static_cast<int>(W_.cols()), beta_, interval.snapshots(), interval.re(0),
                 interval.im(0), W_.re.data(), W_.im.data(), P_.re.data(), P_.im.data(), work(0), work(1), work(2),
                 work(3), work(4), work(5)});
}

}  // namespace truebearing
