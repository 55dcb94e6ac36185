// SPDX-License-Identifier: Apache-2.0
#include "truebearing/array/sample_covariance.hpp"

#include <cmath>
#include <limits>

#include "truebearing/core/linear_algebra.hpp"

namespace truebearing {

void sample_covariance(const Interval& interval, Eigen::MatrixXcd& R) {
  const int M = interval.sensors();
  R.setZero(M, M);
  for (int t = 0; t < interval.snapshots(); ++t)
    for (int j = 0; j < M; ++j) {
      const std::complex<double> x_j = std::conj(interval.value(t, j));
      for (int i = 0; i < M; ++i) R(i, j) += interval.value(t, i) * x_j;
    }
  R /= std::max<double>(1.0, interval.snapshots());
}

SignalSubspace signal_subspace(const Eigen::MatrixXcd& R, int N) {
  const HermitianModes modes = hermitian_modes(R);
  return {modes.vectors.rightCols(N).rowwise().reverse(), modes.values};
}

int source_count(const Eigen::VectorXd& eigenvalues, int snapshots, OrderCriterion criterion) {
  const int M = static_cast<int>(eigenvalues.size());
  const double least = 1e-12 * std::max(eigenvalues[M - 1], 1e-300);
  int best = 0;
  double best_cost = std::numeric_limits<double>::infinity();
  for (int n = 0; n < M; ++n) {
    const Eigen::ArrayXd noise = eigenvalues.head(M - n).array().max(least);
    const double misfit = snapshots * (M - n) * (std::log(noise.mean()) - noise.log().mean());
    const double parameters = n * (2.0 * M - n);
    const double penalty = criterion == OrderCriterion::akaike ? parameters : 0.5 * parameters * std::log(snapshots);
    if (misfit + penalty < best_cost) {
      best_cost = misfit + penalty;
      best = n;
    }
  }
  return best;
}

}  // namespace truebearing
