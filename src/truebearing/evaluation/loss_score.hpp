// SPDX-License-Identifier: Apache-2.0
// How near a run came to losing its target.
#pragma once

#include "truebearing/evaluation/run_score.hpp"

namespace truebearing {

/// The largest last scored error of a run in units of its loss threshold, over the quantities that have one and the
/// targets: above 1 the run is lost. Infinite where a target has no error; 0 without thresholds. scorer: of the
/// tracker.
double loss_score(const RunScore& score, const Scorer& scorer, const ScoringRule& rule);

}  // namespace truebearing
