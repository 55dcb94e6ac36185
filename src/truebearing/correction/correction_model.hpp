// SPDX-License-Identifier: Apache-2.0
// CorrectionModel: all that a trained correction is made of, as it stands in a model file. Immutable while it runs.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "truebearing/core/state_space.hpp"
#include "truebearing/correction/box_gate.hpp"
#include "truebearing/correction/correction_design.hpp"
#include "truebearing/correction/fuzzy_network.hpp"

namespace truebearing {

struct CorrectionModel {
  const StateSpace* space = nullptr;  ///< of the base's and the reference's state, and of the correction

  CorrectionDesign design;
  /// Configuration of every tracker that takes part, as the study spelt it: a correction belongs to these.
  std::map<std::string, std::string> trackers;

  FuzzyNetwork network;
  std::optional<BoxGate> gate;  ///< the box that the training data filled; absent: always open

  /// The correction's own covariance, from one of two heads; the other is empty. `inflation` (M), > 0:
  /// (sum_j phi_j inflation_j) P, P that of `covariance_of`.
  Eigen::VectorXd inflation;
  /// Or, where the design says so, `moments` (M x n n), each row a covariance in the frame, in standard deviations
  /// sigma of `covariance_of` there: diag(sigma) (sum_j phi_j Sigma_j) diag(sigma). A mean of covariances is one.
  Eigen::MatrixXd moments;

  // For the reader, per rule: what it is used for, and what the teacher said where it was used.
  Eigen::VectorXd usage;       ///< (M), mean phi over the training data
  Eigen::MatrixXd local_mean;  ///< (M x n), phi-weighted mean of the teacher signal, in the units of the outputs

  std::map<std::string, std::string> provenance;  ///< where it comes from: study, seed, runs, version, scores

  /// What the covariance head makes of rule strengths phi (M) and the covariance P (n x n) of `covariance_of`, P and
  /// the result both in the frame. Any units: sigma is that of P.
  BoundedMatrix head_covariance(const FuzzyNetwork::Strengths& phi, const BoundedMatrix& P) const;

  /// Throws InputError where parts disagree in shape, are not finite or out of range.
  void validate() const;
};

}  // namespace truebearing
