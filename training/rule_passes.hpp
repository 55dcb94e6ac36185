// SPDX-License-Identifier: Apache-2.0
// What variable projection takes from many rows: the normal equations of the consequents, and the gradient by the
// exponents' coefficients. Blocks of rows are shared among threads, and their sums are added in the order of the blocks:
// the same bits on any number of threads.
//
// U (n x d) inputs, T (n x p) targets, Phi (n x M) normalised strengths. Internal to the trainers.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "training/fuzzy_training.hpp"

namespace truebearing {

/// E (2d+1 x M) with [1, U, U^2] E = -sum_i (u_i - c_ji)^2 / (2 s_ji^2): a rule's exponent is linear in that basis.
Eigen::MatrixXd exponent_coefficients(const Eigen::MatrixXd& centres, const Eigen::MatrixXd& widths);

/// Sums over rows: Phi'Phi, Phi'T, Phi'1, and of the squares of T.
struct StrengthSums {
  Eigen::Index rows = 0;
  Eigen::MatrixXd squared;          ///< Phi'Phi, its lower triangle
  Eigen::MatrixXd by_targets;       ///< Phi'T
  Eigen::VectorXd sum;              ///< Phi'1
  Eigen::VectorXd targets_squared;  ///< (p)

  /// Zeros.
  StrengthSums(Eigen::Index rules, Eigen::Index outputs);
  StrengthSums() = default;
};

class RulePasses {
 public:
  explicit RulePasses(int threads);  ///< 0: one per core

  /// Of `chosen` columns of `rows`, with the coefficients E of rules.
  const StrengthSums& sums(const NormalisedRows& rows, std::span<const Eigen::Index> chosen, const Eigen::MatrixXd& E);
  /// The same, and remembers the strengths for gradient().
  const StrengthSums& sums_to_go_on(const NormalisedRows& rows, std::span<const Eigen::Index> chosen,
                                    const Eigen::MatrixXd& E);

  struct Gradient {
    double cost = 0.0;                ///< sum over rows and outputs of weight_o (t - y)^2
    Eigen::MatrixXd by_coefficients;  ///< (2d+1 x M): [1, U, U^2]' G, G_nj = phi_nj (r_n.y_n - r_n.w_j), r weighted
  };
  /// At the rows and strengths of the last sums_to_go_on(), of consequents W (M x p) and the outputs' weights (p).
  const Gradient& gradient(const Eigen::MatrixXd& W, const Eigen::VectorXd& weights);

 private:
  // What one worker needs for a block.
  struct Scratch {
    Eigen::MatrixXd basis;      // V (kBlockStride x 2d+1)
    Eigen::MatrixXd basis_row;  // V', filled up with zeros to whole lanes
    Eigen::MatrixXd by_rule;    // Phi (kBlockStride x M)
    Eigen::MatrixXd by_row;     // Phi' where it is not remembered
    Eigen::MatrixXd targets;    // T', filled up
    Eigen::MatrixXd outputs, residuals, gradient;
    Eigen::VectorXd outputs_sum;
  };
  struct BlockGradient {
    double cost;
    Eigen::MatrixXd by_basis;  // (M x 2d+1), both filled up
  };

  void add_sums(const Eigen::MatrixXd& E, bool remember);
  void fill_basis_row(std::span<const Eigen::Index> block, Scratch& scratch) const;
  void take_sums(std::span<const Eigen::Index> block, const Eigen::MatrixXd& E, double* by_row, Scratch& scratch,
                 StrengthSums& sums) const;
  void take_gradient(std::span<const Eigen::Index> block, const double* by_row, const Eigen::MatrixXd& W,
                     const Eigen::MatrixXd& W_by_row, const Eigen::VectorXd& weights, Scratch& scratch,
                     BlockGradient& gradient) const;

  int threads_;
  std::vector<Scratch> scratch_;  // [worker]
  const NormalisedRows* rows_ = nullptr;
  std::span<const Eigen::Index> chosen_;
  Eigen::MatrixXd strengths_;  // Phi' (M, filled up, x n), from one pass to the other
  std::vector<StrengthSums> block_sums_;
  std::vector<BlockGradient> block_gradients_;
  StrengthSums sums_;
  Gradient gradient_;
};

}  // namespace truebearing
