// SPDX-License-Identifier: Apache-2.0
#include "training/covariance_inflation.hpp"

#include <string>

#include "truebearing/core/error.hpp"

namespace truebearing {

Eigen::VectorXd covariance_inflation(const FuzzyNetwork& network, const Eigen::MatrixXd& features,
                                     const Eigen::VectorXd& normalised_squared_errors, double usage_floor) {
  const Eigen::Index rows = features.rows();
  if (rows < 1 || normalised_squared_errors.size() != rows || features.cols() != network.inputs()) {
    throw InputError("covariance inflation",
                     std::to_string(rows) + " x " + std::to_string(features.cols()) + " features and " +
                         std::to_string(normalised_squared_errors.size()) + " errors",
                     std::to_string(network.inputs()) + " features and one error per row");
  }
  if (!features.allFinite() || !normalised_squared_errors.allFinite() || normalised_squared_errors.minCoeff() < 0.0) {
    throw InputError("covariance inflation", "a number that is not finite, or a negative squared error");
  }
  FuzzyNetwork::Strengths phi;
  Eigen::VectorXd strengths_sum = Eigen::VectorXd::Zero(network.rules());
  Eigen::VectorXd errors_sum = Eigen::VectorXd::Zero(network.rules());
  for (Eigen::Index n = 0; n < rows; ++n) {
    network.strengths(features.row(n).transpose(), phi);
    strengths_sum += phi;
    errors_sum += normalised_squared_errors[n] * phi;
  }
  const double mean = normalised_squared_errors.mean();
  const double enough = usage_floor * static_cast<double>(rows);
  return (strengths_sum.array() > 0.0 && strengths_sum.array() >= enough)
      .select(errors_sum.array() / strengths_sum.array(), mean);
}

}  // namespace truebearing
