// CorrectionModel: all that a trained correction is made of, as it stands in a model file. Immutable while it runs.
#pragma once

#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "truebearing/core/state_space.hpp"
#include "truebearing/correction/box_gate.hpp"
#include "truebearing/correction/feature.hpp"
#include "truebearing/correction/fuzzy_network.hpp"

namespace truebearing {

struct CorrectionModel {
  const StateSpace* space = nullptr;  ///< of the base's and the reference's state, and of the correction

  std::string base;           ///< the tracker whose output is corrected
  std::string reference;      ///< the tracker that is trusted: the base itself, or a tuned one
  std::string covariance_of;  ///< the tracker whose covariance is inflated into the correction's own
  /// Configuration of every tracker that takes part, as the study spelt it: a correction belongs to these.
  std::map<std::string, std::string> trackers;

  std::vector<FeatureSpec> features;
  FuzzyNetwork network;
  std::optional<BoxGate> gate;                             ///< absent: always open
  double kappa = std::numeric_limits<double>::infinity();  ///< infinity: not limited
  Eigen::VectorXd inflation;  ///< (M), > 0: P_correction = (sum_j phi_j inflation_j) P of `covariance_of`

  // For the reader, per rule: what it is used for, and what the teacher said where it was used.
  Eigen::VectorXd usage;       ///< (M), mean phi over the training data
  Eigen::MatrixXd local_mean;  ///< (M x n), phi-weighted mean of the teacher signal, in the units of the state

  std::map<std::string, std::string> provenance;  ///< where it comes from: study, seed, runs, version, scores

  /// Throws InputError where parts disagree in shape, are not finite or out of range.
  void validate() const;
};

}  // namespace truebearing
