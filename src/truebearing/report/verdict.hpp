// SPDX-License-Identifier: Apache-2.0
// The results in sentences: what was asked, and the answer.
#pragma once

#include <string>

#include "truebearing/report/results.hpp"

namespace truebearing {

/// "Does nfnn err less than tuned? radar_1d_family, 1000 runs, seed 1."
std::string question(const Results& results);

/// "nfnn is 14 % below tuned in position (9 standard errors); 17 % above the bound bayes_bank; consistent (NEES 2.02, 2
/// expected)." Of the first pair that was compared; of the tracker with the least RMSE where none was.
std::string answer(const Results& results);

/// Is the mean NEES where 95 % of consistent trackers' would be? Steps of one run depend on each other: a run counts as
/// one. "consistent", "claims to know more than it does", "knows more than it claims"; empty where there is no NEES.
std::string consistency(const ResultTracker& tracker, double runs);

/// The tracker with the least RMSE in that quantity, bounds apart; nullptr where none has it.
const ResultTracker* best_in(const ResultFigures& figures, const std::string& quantity);

/// b's RMSE is 0 % of the way, the bound's all of it: how far a is, in percent; NaN where the bound is not below b.
double share_of_the_way(double a, double b, double bound);

}  // namespace truebearing
