// SPDX-License-Identifier: Apache-2.0
// Figures of what trackers notice (tracker/tracker.hpp), from the events of a tracker's runs. Events count by their own
// times, which may lie before the steps that noticed them.
#pragma once

#include <memory>
#include <optional>

#include "truebearing/evaluation/metric_family.hpp"

namespace truebearing {

struct EventFigures : RunFigures {
  std::vector<TrackEvent> events;    ///< that the tracker reported by the end of the run
  std::optional<double> turns_at_s;  ///< of the truth (recording/recording.hpp), where there is one target
};

/// Nothing for a tracker that reported no event of any kind in any run.
///   source_change_share  share of runs with a source_changed, where the truth has a frequency
///   turn_delay           mean of the time from the true turn to the first turn_began at or after it, over the runs
///                        that have both
///   turn_found_share     share of the runs whose target turns that have one
///   false_turn_share     share of runs with a turn_began before the true turn, or whose target does not turn
/// The last three are over the runs in which it is told when the target turns, and absent where there is no such run;
/// the two in the middle are absent where no target turns.
std::shared_ptr<const MetricFamily> event_metrics();

}  // namespace truebearing
