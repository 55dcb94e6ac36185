// SPDX-License-Identifier: Apache-2.0
// The variable-projection cost of a fuzzy network with scattered rules (Golub and Pereyra 1973): the consequents W are
// eliminated by ridge least squares, and what is left is a function of centres c and widths s (both M x d) alone,
//     J(c, s) = min_W sum_o weight_o ( 1/n |t_o - Phi w_o|^2 + lambda/M |w_o|^2 ).
// As W is optimal, its own change adds nothing to first order: the gradient of J is the partial one at that W.
//
// U (n x d) inputs, T (n x p) targets, Phi (n x M) normalised strengths. Internal to the trainers.
//
// Rules in mirror pairs: the second half of the M rules mirrors the first, c_(M/2+j) = parity c_j, and its consequents
// are w_(M/2+j) = sign w_j, output by output.
#pragma once

#include <Eigen/Core>
#include <utility>

namespace truebearing {

/// V (n x 2d+1) = [1, U, U^2]: a rule's exponent is linear in it.
Eigen::MatrixXd exponent_basis(const Eigen::MatrixXd& U);
/// E (2d+1 x M) with V E = -sum_i (u_i - c_ji)^2 / (2 s_ji^2).
Eigen::MatrixXd exponent_coefficients(const Eigen::MatrixXd& centres, const Eigen::MatrixXd& widths);

/// Rows that are worked on at once: a block of strengths stays in the cache.
inline constexpr Eigen::Index kBlockRows = 256;

/// Phi (n x M) of at most kBlockRows rows V.
void block_strengths(const Eigen::Ref<const Eigen::MatrixXd>& V, const Eigen::MatrixXd& coefficients,
                     Eigen::Ref<Eigen::MatrixXd> phi);

/// Phi'Phi, Phi'T and Phi'1, accumulated over blocks of rows.
class ConsequentEquations {
 public:
  ConsequentEquations(Eigen::Index rules, Eigen::Index outputs);
  void add(const Eigen::Ref<const Eigen::MatrixXd>& phi, const Eigen::Ref<const Eigen::MatrixXd>& T);
  /// W (M x p) = (Phi'Phi + lambda n/M I)^-1 Phi'T, lambda > 0; the best in mirror pairs with the `pair_signs` (p) of
  /// the outputs where those are given.
  Eigen::MatrixXd consequents(double lambda, const Eigen::VectorXd& pair_signs = {}) const;
  Eigen::VectorXd usage() const;       ///< (M), mean of phi
  Eigen::MatrixXd local_mean() const;  ///< (M x p), phi-weighted mean of the targets; 0 for a rule that is never used
  /// Of consequents W, per output: 1/n |t_o - Phi w_o|^2 + lambda/M |w_o|^2.
  Eigen::VectorXd cost(const Eigen::MatrixXd& W, double lambda) const;

 private:
  double rows_ = 0.0;
  Eigen::MatrixXd strengths_squared_;     // (M x M), lower triangle
  Eigen::MatrixXd strengths_by_targets_;  // (M x p)
  Eigen::VectorXd strengths_sum_;         // (M)
  Eigen::VectorXd targets_squared_;       // (p)
};

class ProjectedCost {
 public:
  /// pair_signs (p): the outputs' where rules come in mirror pairs, else empty.
  ProjectedCost(Eigen::VectorXd output_weights, double lambda, Eigen::VectorXd pair_signs = {})
      : output_weights_(std::move(output_weights)), lambda_(lambda), pair_signs_(std::move(pair_signs)) {}

  struct Gradient {
    Eigen::MatrixXd centres;     ///< (M x d), dJ/dc
    Eigen::MatrixXd log_widths;  ///< (M x d), dJ/d(ln s)
  };
  /// J on rows U (n x d), T (n x p), n >= 1, at these centres and widths, and its gradient.
  double evaluate(const Eigen::MatrixXd& U, const Eigen::MatrixXd& T, const Eigen::MatrixXd& centres,
                  const Eigen::MatrixXd& widths, Gradient& gradient);

 private:
  Eigen::VectorXd output_weights_;
  double lambda_;
  Eigen::VectorXd pair_signs_;
  Eigen::MatrixXd phi_;  // block by block, (kBlockRows x M) each: kept between the two passes over the rows
};

}  // namespace truebearing
