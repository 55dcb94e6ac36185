// SPDX-License-Identifier: Apache-2.0
#include "training/projected_cost.hpp"

#include <Eigen/Cholesky>
#include <algorithm>

namespace truebearing {
namespace {

// Strengths below exp(-300) mean nothing, and their products would be denormal and slow.
constexpr double kLowestExponent = -300.0;

}  // namespace

Eigen::MatrixXd exponent_basis(const Eigen::MatrixXd& U) {
  Eigen::MatrixXd V(U.rows(), 2 * U.cols() + 1);
  V << Eigen::VectorXd::Ones(U.rows()), U, U.cwiseAbs2();
  return V;
}

Eigen::MatrixXd exponent_coefficients(const Eigen::MatrixXd& centres, const Eigen::MatrixXd& widths) {
  const Eigen::Index d = centres.cols();
  const Eigen::MatrixXd precision = widths.array().square().inverse();
  Eigen::MatrixXd coefficients(2 * d + 1, centres.rows());
  coefficients.row(0) = -0.5 * centres.cwiseAbs2().cwiseProduct(precision).rowwise().sum().transpose();
  coefficients.middleRows(1, d) = centres.cwiseProduct(precision).transpose();
  coefficients.bottomRows(d) = -0.5 * precision.transpose();
  return coefficients;
}

void block_strengths(const Eigen::Ref<const Eigen::MatrixXd>& V, const Eigen::MatrixXd& coefficients,
                     Eigen::Ref<Eigen::MatrixXd> phi) {
  using Column = Eigen::Array<double, Eigen::Dynamic, 1, 0, kBlockRows, 1>;
  phi.noalias() = V * coefficients;
  Column peak = phi.col(0).array();
  for (Eigen::Index j = 1; j < phi.cols(); ++j) peak = peak.max(phi.col(j).array());
  Column sum = Column::Zero(phi.rows());
  for (Eigen::Index j = 0; j < phi.cols(); ++j) {
    phi.col(j).array() = (phi.col(j).array() - peak).max(kLowestExponent).exp();
    sum += phi.col(j).array();
  }
  sum = sum.inverse();
  for (Eigen::Index j = 0; j < phi.cols(); ++j) phi.col(j).array() *= sum;
}

ConsequentEquations::ConsequentEquations(Eigen::Index rules, Eigen::Index outputs)
    : strengths_squared_(Eigen::MatrixXd::Zero(rules, rules)),
      strengths_by_targets_(Eigen::MatrixXd::Zero(rules, outputs)),
      strengths_sum_(Eigen::VectorXd::Zero(rules)),
      targets_squared_(Eigen::VectorXd::Zero(outputs)) {}

void ConsequentEquations::add(const Eigen::Ref<const Eigen::MatrixXd>& phi,
                              const Eigen::Ref<const Eigen::MatrixXd>& T) {
  rows_ += static_cast<double>(phi.rows());
  strengths_squared_.selfadjointView<Eigen::Lower>().rankUpdate(phi.transpose());
  strengths_by_targets_.noalias() += phi.transpose() * T;
  strengths_sum_ += phi.colwise().sum().transpose();
  targets_squared_ += T.colwise().squaredNorm().transpose();
}

Eigen::MatrixXd ConsequentEquations::consequents(double lambda, const Eigen::VectorXd& pair_signs) const {
  const Eigen::Index M = strengths_squared_.rows();
  const double ridge = lambda * rows_ / static_cast<double>(M);
  if (pair_signs.size() == 0) {
    Eigen::MatrixXd A = strengths_squared_;
    A.diagonal().array() += ridge;
    return A.llt().solve(strengths_by_targets_);
  }
  // The strengths of a pair, added with the output's sign, are one column: half the unknowns, one system per sign.
  const Eigen::Index half = M / 2;
  const Eigen::MatrixXd A = strengths_squared_.selfadjointView<Eigen::Lower>();
  Eigen::MatrixXd W(M, pair_signs.size());
  for (Eigen::Index o = 0; o < pair_signs.size(); ++o) {
    const double sign = pair_signs[o];
    Eigen::MatrixXd paired = A.topLeftCorner(half, half) + A.bottomRightCorner(half, half) +
                             sign * (A.topRightCorner(half, half) + A.bottomLeftCorner(half, half));
    paired.diagonal().array() += 2.0 * ridge;
    const Eigen::VectorXd targets =
        strengths_by_targets_.col(o).head(half) + sign * strengths_by_targets_.col(o).tail(half);
    W.col(o).head(half) = paired.llt().solve(targets);
    W.col(o).tail(half) = sign * W.col(o).head(half);
  }
  return W;
}

Eigen::VectorXd ConsequentEquations::usage() const {
  return strengths_sum_ / rows_;
}

Eigen::MatrixXd ConsequentEquations::local_mean() const {
  return strengths_sum_.cwiseMax(1e-100).cwiseInverse().asDiagonal() * strengths_by_targets_;
}

Eigen::VectorXd ConsequentEquations::cost(const Eigen::MatrixXd& W, double lambda) const {
  const Eigen::MatrixXd AW = strengths_squared_.selfadjointView<Eigen::Lower>() * W;
  const Eigen::RowVectorXd residuals_squared = targets_squared_.transpose() -
                                               2.0 * W.cwiseProduct(strengths_by_targets_).colwise().sum() +
                                               W.cwiseProduct(AW).colwise().sum();
  return residuals_squared.transpose() / rows_ +
         lambda / static_cast<double>(W.rows()) * W.colwise().squaredNorm().transpose();
}

double ProjectedCost::evaluate(const Eigen::MatrixXd& U, const Eigen::MatrixXd& T, const Eigen::MatrixXd& centres,
                               const Eigen::MatrixXd& widths, Gradient& gradient) {
  const Eigen::Index rules = centres.rows();
  const Eigen::Index d = centres.cols();
  const Eigen::MatrixXd coefficients = exponent_coefficients(centres, widths);
  const Eigen::MatrixXd V = exponent_basis(U);
  phi_.resize(kBlockRows, rules * ((V.rows() + kBlockRows - 1) / kBlockRows));
  const auto phi_block = [&](Eigen::Index first, Eigen::Index count) {
    return phi_.block(0, first / kBlockRows * rules, count, rules);
  };

  ConsequentEquations equations(rules, T.cols());
  for (Eigen::Index first = 0; first < V.rows(); first += kBlockRows) {
    const Eigen::Index count = std::min(kBlockRows, V.rows() - first);
    auto phi = phi_block(first, count);
    block_strengths(V.middleRows(first, count), coefficients, phi);
    equations.add(phi, T.middleRows(first, count));
  }
  const Eigen::MatrixXd W = equations.consequents(lambda_, pair_signs_);

  // The gradient by the exponents e_nj is G = 2/n phi_nj (r.y_n - r.w_j) with r weighted; through V it is V'G.
  double cost = lambda_ / static_cast<double>(rules) * W.colwise().squaredNorm().dot(output_weights_);
  Eigen::MatrixXd by_coefficients = Eigen::MatrixXd::Zero(V.cols(), rules);
  Eigen::MatrixXd y, r, G;
  const double mean = 1.0 / static_cast<double>(V.rows());
  for (Eigen::Index first = 0; first < V.rows(); first += kBlockRows) {
    const Eigen::Index count = std::min(kBlockRows, V.rows() - first);
    const auto phi = phi_block(first, count);
    y.noalias() = phi * W;
    r = T.middleRows(first, count) - y;
    cost += mean * r.colwise().squaredNorm().dot(output_weights_);
    r *= output_weights_.asDiagonal();
    G.noalias() = -r * W.transpose();
    G.colwise() += r.cwiseProduct(y).rowwise().sum();
    G.array() *= phi.array();
    by_coefficients.noalias() += V.middleRows(first, count).transpose() * G;
  }
  by_coefficients *= 2.0 * mean;

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
