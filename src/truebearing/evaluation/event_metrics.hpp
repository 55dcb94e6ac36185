// Figures of what trackers notice (tracker/tracker.hpp), from the scores of a tracker's runs. Events count by their own
// times, which may lie before the steps that noticed them.
#pragma once

#include <vector>

#include "truebearing/evaluation/metric.hpp"
#include "truebearing/evaluation/run_score.hpp"

namespace truebearing {

/// scores: [run], of one tracker; nothing for one that reported no event of any kind in any run.
///   source_change_share  share of runs with a source_changed, where the truth has a frequency
///   turn_delay           mean of the time from the true turn to the first turn_began at or after it, over the runs
///   that
///                        have both
///   turn_found_share     share of the runs whose target turns that have one
///   false_turn_share     share of runs with a turn_began before the true turn, or whose target does not turn
/// The last three are over the runs in which it is told when the target turns, and absent where there is no such run;
/// the two in the middle are absent where no target turns.
std::vector<Metric> event_metrics(const Scorer& scorer, const std::vector<const RunScore*>& scores);

}  // namespace truebearing
