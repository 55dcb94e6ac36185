// SPDX-License-Identifier: Apache-2.0
// RuleBase: a fuzzy network with the covariance that each of its rules learned, and what a reader wants to know of them.
#pragma once

#include <Eigen/Core>

#include "truebearing/correction/correction_design.hpp"
#include "truebearing/correction/fuzzy_network.hpp"
#include "truebearing/correction/network_answer.hpp"

namespace truebearing {

struct RuleBase {
  FuzzyNetwork network;

  /// The correction's own covariance, from one of two heads; the other is empty. `inflation` (M), > 0:
  /// (sum_j phi_j inflation_j) P, P that of `covariance_of`.
  Eigen::VectorXd inflation;
  /// Or, where the design says so, `moments` (M x n n), each row a covariance in the frame, in standard deviations
  /// sigma of `covariance_of` there: diag(sigma) (sum_j phi_j Sigma_j) diag(sigma). A mean of covariances is one.
  Eigen::MatrixXd moments;

  // For the reader, per rule: what it is used for, and what the teacher said where it was used.
  Eigen::VectorXd usage;       ///< (M), mean phi over the training data
  Eigen::MatrixXd local_mean;  ///< (M x n), phi-weighted mean of the teacher signal, in the units of the outputs

  int inputs() const { return network.inputs(); }
  int outputs() const { return network.outputs(); }
  int memory() const { return 0; }
  const FuzzyNetwork::Parameters& parameters() const { return network.parameters(); }
  void answer(const NetworkInputs& inputs, NetworkMemory& memory, NetworkAnswer& answer) const;
  void check(const CorrectionDesign& design, int state) const;
};

}  // namespace truebearing
