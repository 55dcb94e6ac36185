// SPDX-License-Identifier: Apache-2.0
#include "truebearing/array/orthogonal_iteration.hpp"

#include <cmath>

namespace truebearing {

void OrthogonalIteration::begin(const Eigen::MatrixXcd& basis) {
  W_.re = basis.real();
  W_.im = basis.imag();
  next_.setZero(basis.rows(), basis.cols());
}

void OrthogonalIteration::update(const Interval& interval) {
  next_.re.setZero();
  next_.im.setZero();
  for (int t = 0; t < interval.snapshots(); ++t)
    for (Eigen::Index n = 0; n < W_.cols(); ++n) {  // x (x^H w)
      std::complex<double> product = 0.0;
      for (int m = 0; m < interval.sensors(); ++m)
        product += std::conj(interval.value(t, m)) * std::complex<double>(W_.re(m, n), W_.im(m, n));
      for (int m = 0; m < interval.sensors(); ++m) {
        const std::complex<double> part = interval.value(t, m) * product;
        next_.re(m, n) += part.real();
        next_.im(m, n) += part.imag();
      }
    }
  std::swap(W_, next_);
  orthonormalise();
}

// Modified Gram-Schmidt. A column of which nothing is left keeps its direction of before.
void OrthogonalIteration::orthonormalise() {
  for (Eigen::Index n = 0; n < W_.cols(); ++n) {
    for (Eigen::Index k = 0; k < n; ++k) {
      const double re = W_.re.col(k).dot(W_.re.col(n)) + W_.im.col(k).dot(W_.im.col(n));
      const double im = W_.re.col(k).dot(W_.im.col(n)) - W_.im.col(k).dot(W_.re.col(n));
      W_.re.col(n) -= W_.re.col(k) * re - W_.im.col(k) * im;
      W_.im.col(n) -= W_.re.col(k) * im + W_.im.col(k) * re;
    }
    const double length = std::sqrt(W_.re.col(n).squaredNorm() + W_.im.col(n).squaredNorm());
    if (!(length > 0.0)) {
      W_.re.col(n) = next_.re.col(n);
      W_.im.col(n) = next_.im.col(n);
      continue;
    }
    W_.re.col(n) /= length;
    W_.im.col(n) /= length;
  }
}

}  // namespace truebearing
