// SPDX-License-Identifier: Apache-2.0
// Figures of several targets whose tracks are told by their numbers: swaps and losses of tracks, and squared errors of
// the runs without any. Key of [scoring]; last_steps is optional:
//   tracks = { quantity = "angle_deg", bad = 3.0, last_steps = 5, excursion = 6.0 }
#pragma once

#include <memory>
#include <string>

#include "truebearing/evaluation/metric_family.hpp"
#include "truebearing/evaluation/track_outcome.hpp"

namespace truebearing {

struct TrackFigures : StepFigures {
  TrackOutcome outcome;
  std::vector<std::string> phases;  ///< their names in the run
};

/// With q the rule's quantity; nothing of a tracker that does not estimate it.
///   all_mse, clean_mse    mean of the squared error of q over runs, targets and scored steps; of the clean runs alone
///   rate_clean_mse        the same of another quantity, by its name
///   swap_runs, lost_runs  runs in which a track swapped; of the others, those in which one was lost
///   bad_share             share of runs with either
///   excursion_runs        runs in which an error passed the rule's limit
///   clean_runs            runs with none of the three
/// Paired, as angle_deg2_clean and, by phase, angle_deg2_clean_crossing: the difference of the two runs' mean squared
/// errors, over the runs that are clean with both trackers.
std::shared_ptr<const MetricFamily> track_metrics(TrackRule rule);

}  // namespace truebearing
