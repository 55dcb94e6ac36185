// SPDX-License-Identifier: Apache-2.0
#include "training/projected_cost.hpp"

#include <Eigen/Cholesky>

namespace truebearing {

Eigen::MatrixXd ConsequentEquations::consequents(double lambda, const Eigen::VectorXd& pair_signs) const {
  const Eigen::Index M = sums_.squared.rows();
  const double ridge = lambda * rows_ / static_cast<double>(M);
  if (pair_signs.size() == 0) {
    Eigen::MatrixXd A = sums_.squared;
    A.diagonal().array() += ridge;
    return A.llt().solve(sums_.by_targets);
  }
  // The strengths of a pair, added with the output's sign, are one column: half the unknowns, one system per sign.
  const Eigen::Index half = M / 2;
  const Eigen::MatrixXd A = sums_.squared.selfadjointView<Eigen::Lower>();
  Eigen::MatrixXd W(M, pair_signs.size());
  for (Eigen::Index o = 0; o < pair_signs.size(); ++o) {
    const double sign = pair_signs[o];
    Eigen::MatrixXd paired = A.topLeftCorner(half, half) + A.bottomRightCorner(half, half) +
                             sign * (A.topRightCorner(half, half) + A.bottomLeftCorner(half, half));
    paired.diagonal().array() += 2.0 * ridge;
    const Eigen::VectorXd targets = sums_.by_targets.col(o).head(half) + sign * sums_.by_targets.col(o).tail(half);
    W.col(o).head(half) = paired.llt().solve(targets);
    W.col(o).tail(half) = sign * W.col(o).head(half);
  }
  return W;
}

Eigen::VectorXd ConsequentEquations::usage() const {
  return sums_.sum / rows_;
}

Eigen::MatrixXd ConsequentEquations::local_mean() const {
  return sums_.sum.cwiseMax(1e-100).cwiseInverse().asDiagonal() * sums_.by_targets;
}

Eigen::VectorXd ConsequentEquations::cost(const Eigen::MatrixXd& W, double lambda) const {
  const Eigen::MatrixXd AW = sums_.squared.selfadjointView<Eigen::Lower>() * W;
  const Eigen::RowVectorXd residuals_squared = sums_.targets_squared.transpose() -
                                               2.0 * W.cwiseProduct(sums_.by_targets).colwise().sum() +
                                               W.cwiseProduct(AW).colwise().sum();
  return residuals_squared.transpose() / rows_ +
         lambda / static_cast<double>(W.rows()) * W.colwise().squaredNorm().transpose();
}

double ProjectedCost::evaluate(const NormalisedRows& rows, std::span<const Eigen::Index> chosen,
                               const Eigen::MatrixXd& centres, const Eigen::MatrixXd& widths, Gradient& gradient) {
  const Eigen::Index rules = centres.rows();
  const Eigen::Index d = centres.cols();
  const ConsequentEquations equations(passes_.sums_to_go_on(rows, chosen, exponent_coefficients(centres, widths)));
  const Eigen::MatrixXd W = equations.consequents(lambda_, pair_signs_);

  // The gradient by the exponents e_nj is 2/n phi_nj (r.y_n - r.w_j) with r weighted.
  const RulePasses::Gradient& by_exponents = passes_.gradient(W, output_weights_);
  const double mean = 1.0 / static_cast<double>(chosen.size());
  const double cost =
      lambda_ / static_cast<double>(rules) * W.colwise().squaredNorm().dot(output_weights_) + mean * by_exponents.cost;
  const Eigen::MatrixXd by_coefficients = 2.0 * mean * by_exponents.by_coefficients;

  // Chain rule through exponent_coefficients.
  const auto by_1 = by_coefficients.row(0).transpose().replicate(1, d).array();
  const auto by_u = by_coefficients.middleRows(1, d).transpose().array();
  const auto by_u2 = by_coefficients.bottomRows(d).transpose().array();
  const auto c = centres.array();
  const Eigen::ArrayXXd precision = widths.array().square().inverse();
  gradient.centres = precision * (by_u - c * by_1);
  gradient.log_widths = precision * (by_u2 - 2.0 * c * by_u + c.square() * by_1);
  return cost;
}

}  // namespace truebearing
