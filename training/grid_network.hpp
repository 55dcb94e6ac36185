// SPDX-License-Identifier: Apache-2.0
// The fuzzy network on a grid partition, as back-propagation sees it: terms are shared by all rules of the grid that
// use them, so their gradients add up. With terms normalised per input, mu_bar, the strengths are phi = prod_i
// mu_bar_i.
//
// d inputs with K_i terms each, M = prod K_i rules (last input fastest), p outputs. Internal to the trainers.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "truebearing/correction/fuzzy_partition.hpp"

namespace truebearing {

/// The parameters of a grid network, or the gradient of a cost by them.
struct GridParameters {
  Eigen::VectorXd centres;      ///< (sum K_i), input by input
  Eigen::VectorXd log_widths;   ///< (sum K_i)
  Eigen::MatrixXd consequents;  ///< W (p x M)

  void set_zero_like(const GridParameters& other);
};

class GridNetwork {
 public:
  /// Consequents 0.
  GridNetwork(const FuzzyPartition& partition, int outputs);

  FuzzyPartition partition() const;

  /// 1/2 sum_o weight_o (t_o - y_o(u))^2 for one row u (d), t (p); its gradient is added to `gradient`.
  double add_gradient(const Eigen::VectorXd& u, const Eigen::VectorXd& t, const Eigen::VectorXd& weights,
                      GridParameters& gradient);

  GridParameters parameters;

 private:
  void spread(const Eigen::VectorXd& u);

  std::vector<Eigen::Index> first_term_;  // (d + 1), where the terms of each input begin
  Eigen::VectorXd memberships_;           // (sum K_i), mu_bar: normalised per input
  Eigen::VectorXd phi_;                   // (M)
  Eigen::VectorXd by_exponent_;           // (M), gradient by the exponents of the rules
  Eigen::VectorXd output_, residual_;     // (p)
};

}  // namespace truebearing
