// SPDX-License-Identifier: Apache-2.0
// The learned rules as sentences that an operator can read: the terms in words, what the network says at the rule's
// centre, how much the rule is used and what the teacher said there.
#pragma once

#include <string>
#include <vector>

#include "truebearing/correction/correction_model.hpp"

namespace truebearing {

/// A rule for a reader.
struct ReportedRule {
  Eigen::Index rule = 0;           ///< its place in the model
  std::vector<std::string> terms;  ///< (d), a word for each feature: term_word()
  Eigen::VectorXd added;           ///< (n), what the network says at the rule's centre
  Eigen::VectorXd taught;          ///< (n), the teacher's mean where the rule was used
  double usage = 0.0;              ///< mean strength over the training data, in [0, 1]
};

/// The most used first.
std::vector<ReportedRule> reported_rules(const CorrectionModel& model);

/// "gain in position_m is MEDIUM AND ..."
std::string conditions_of(const ReportedRule& rule, const CorrectionModel& model);
/// Outputs of the network (n) in words: "+2890 m, +152 m/s" on a line; in a turned frame each with its direction.
std::string amounts(const CorrectionModel& model, const Eigen::VectorXd& outputs);

/// One sentence per rule, the most used first:
/// 1. IF gain in position_m is MEDIUM AND ... THEN add +2890 m, +152 m/s   (usage 12.1 %, teacher's mean +2710 m, +140
/// m/s)
std::string rule_sentences(const CorrectionModel& model);

/// The word for a standardised value u of a feature that is the same for a mirrored target (parity +1) or changes sign
/// (-1).
std::string term_word(double u, int parity);

}  // namespace truebearing
