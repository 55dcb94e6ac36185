// SPDX-License-Identifier: Apache-2.0
#include "training/covariance_moments.hpp"

#include <fmt/format.h>

#include "truebearing/core/error.hpp"

namespace truebearing {

Eigen::MatrixXd covariance_moments(const FuzzyNetwork& network, const Eigen::MatrixXd& features,
                                   const Eigen::MatrixXd& errors, const std::vector<int>& output_parity,
                                   double usage_floor) {
  const Eigen::Index N = features.rows(), p = errors.cols(), M = network.rules();
  if (N < 1 || errors.rows() != N || features.cols() != network.inputs() || p != network.outputs())
    throw InputError("covariance moments",
                     fmt::format("{} x {} features and {} x {} errors", N, features.cols(), errors.rows(), p),
                     fmt::format("{} features and {} errors per row", network.inputs(), network.outputs()));
  if (!features.allFinite() || !errors.allFinite())
    throw InputError("covariance moments", "a number that is not finite");

  Eigen::VectorXd weights = Eigen::VectorXd::Zero(M);
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(M, p * p);
  FuzzyNetwork::Strengths phi;
  BoundedMatrix product(p, p);
  for (Eigen::Index row = 0; row < N; ++row) {
    network.strengths(features.row(row).transpose(), phi);
    product = errors.row(row).transpose() * errors.row(row);
    weights += phi;
    sums += phi * product.reshaped().transpose();
  }
  if (!output_parity.empty()) {
    const Eigen::Index half = M / 2;
    for (Eigen::Index j = 0; j < half; ++j) {
      for (Eigen::Index a = 0; a < p; ++a)
        for (Eigen::Index b = 0; b < p; ++b) {
          const double sign = output_parity[static_cast<std::size_t>(a)] * output_parity[static_cast<std::size_t>(b)];
          const Eigen::Index i = a + p * b;
          sums(j, i) += sign * sums(half + j, i);
          sums(half + j, i) = sign * sums(j, i);
        }
      weights[j] = weights[half + j] = weights[j] + weights[half + j];
    }
  }
  const Eigen::MatrixXd all = errors.transpose() * errors / static_cast<double>(N);
  const double enough = usage_floor * static_cast<double>(N);
  Eigen::MatrixXd moments(M, p * p);
  for (Eigen::Index j = 0; j < M; ++j) {
    if (weights[j] > 0.0 && weights[j] >= enough)
      moments.row(j) = sums.row(j) / weights[j];
    else
      moments.row(j) = all.reshaped().transpose();
  }
  return moments;
}

}  // namespace truebearing
