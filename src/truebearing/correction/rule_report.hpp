// SPDX-License-Identifier: Apache-2.0
// The learned rules as sentences that an operator can read: the terms in words, what the network says at the rule's
// centre, how much the rule is used and what the teacher said there.
#pragma once

#include <string>

#include "truebearing/correction/correction_model.hpp"

namespace truebearing {

/// One sentence per rule, the most used first:
/// `1. IF gain in position_m is MEDIUM AND ... THEN add +2890 m, +152 m/s   (usage 12.1 %, teacher's mean +2710 m, +140
/// m/s)`
std::string rule_sentences(const CorrectionModel& model);

/// The word for a standardised value u of a feature that is the same for a mirrored target (parity +1) or changes sign
/// (-1).
std::string term_word(double u, int parity);

}  // namespace truebearing
