// SPDX-License-Identifier: Apache-2.0
// A grid partition for the fuzzy network, as Fig. 3 of Lee et al.: every input has its own list of Gaussian terms, and
// there is a rule for every combination of terms. On such a full grid normalising each input's terms equals
// normalising their products over the rules (Chao and Teng 1995), the network's softmax.
//
// Terms are given by centre and width per input; rules count through the terms like digits, the last input fastest.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "truebearing/correction/fuzzy_network.hpp"

namespace truebearing {

struct FuzzyPartition {
  std::vector<Eigen::VectorXd> centres;  ///< per input, of its terms; standardised
  std::vector<Eigen::VectorXd> widths;   ///< per input, of its terms; standardised, > 0

  int inputs() const { return static_cast<int>(centres.size()); }
  int terms(int input) const { return static_cast<int>(centres[static_cast<std::size_t>(input)].size()); }
};

/// `terms` (>= 2) terms evenly spaced over [low_i, high_i] for each input i, neighbours crossing at membership 1/2.
FuzzyPartition uniform_partition(const Eigen::VectorXd& low, const Eigen::VectorXd& high, int terms);

/// The full grid of rules: centres and widths expanded, `outputs` consequents of 0, and a unit normalisation, which the
/// caller replaces. Throws InputError where centres and widths disagree or the grid passes FuzzyNetwork::kMaxRules.
FuzzyNetwork::Parameters expand(const FuzzyPartition& partition, int outputs);

}  // namespace truebearing
