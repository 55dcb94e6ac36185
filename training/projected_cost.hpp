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
#include <span>
#include <utility>

#include "training/rule_passes.hpp"

namespace truebearing {

/// The normal equations of the consequents.
class ConsequentEquations {
 public:
  explicit ConsequentEquations(StrengthSums sums) : sums_(std::move(sums)), rows_(static_cast<double>(sums_.rows)) {}
  /// W (M x p) = (Phi'Phi + lambda n/M I)^-1 Phi'T, lambda > 0; the best in mirror pairs with the `pair_signs` (p) of
  /// the outputs where those are given.
  Eigen::MatrixXd consequents(double lambda, const Eigen::VectorXd& pair_signs = {}) const;
  Eigen::VectorXd usage() const;       ///< (M), mean of phi
  Eigen::MatrixXd local_mean() const;  ///< (M x p), phi-weighted mean of the targets; 0 for a rule that is never used
  /// Of consequents W, per output: 1/n |t_o - Phi w_o|^2 + lambda/M |w_o|^2.
  Eigen::VectorXd cost(const Eigen::MatrixXd& W, double lambda) const;

 private:
  StrengthSums sums_;
  double rows_;
};

class ProjectedCost {
 public:
  /// pair_signs (p): the outputs' where rules come in mirror pairs, else empty. threads: 0, one per core.
  ProjectedCost(Eigen::VectorXd output_weights, double lambda, int threads, Eigen::VectorXd pair_signs = {})
      : output_weights_(std::move(output_weights)),
        lambda_(lambda),
        pair_signs_(std::move(pair_signs)),
        passes_(threads) {}

  struct Gradient {
    Eigen::MatrixXd centres;     ///< (M x d), dJ/dc
    Eigen::MatrixXd log_widths;  ///< (M x d), dJ/d(ln s)
  };
  /// J on `chosen` columns of `rows`, at least one, at these centres and widths, and its gradient.
  double evaluate(const NormalisedRows& rows, std::span<const Eigen::Index> chosen, const Eigen::MatrixXd& centres,
                  const Eigen::MatrixXd& widths, Gradient& gradient);

 private:
  Eigen::VectorXd output_weights_;
  double lambda_;
  Eigen::VectorXd pair_signs_;
  RulePasses passes_;
};

}  // namespace truebearing
