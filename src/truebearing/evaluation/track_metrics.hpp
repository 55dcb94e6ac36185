// Figures of several targets, from the scores of a tracker's runs: swaps and losses of tracks, squared errors of the
// runs without any, and the GOSPA of targets that appear and vanish.
#pragma once

#include <string>
#include <vector>

#include "truebearing/evaluation/metric.hpp"
#include "truebearing/evaluation/run_score.hpp"

namespace truebearing {

/// scores: [run], of one tracker; nothing where the rule asks for no tracks. With q the rule's quantity,
///   all_mse, clean_mse    mean of the squared error of q over runs, targets and scored steps; of the clean runs alone
///   rate_clean_mse        the same of another quantity, by its name
///   swap_runs, lost_runs  runs in which a track swapped; of the others, those in which one was lost
///   bad_share             share of runs with either
///   excursion_runs        runs in which an error passed the rule's limit
///   clean_runs            runs with none of the three
std::vector<Metric> track_metrics(const Scorer& scorer, const std::vector<const RunScore*>& scores,
                                  const ScoringRule& rule);

/// The same where the rule asks for GOSPA:
///   gospa, gospa_localisation    root of the mean over runs and scored steps of its square; of the assigned pairs'
///   part missed_targets, false_tracks mean number per scored step
std::vector<Metric> gospa_metrics(const std::vector<const RunScore*>& scores, const ScoringRule& rule);

/// Whether a metric is one of the above.
bool is_track_metric(const std::string& name);

/// Of runs that are clean with both trackers: mean over runs of the difference of the two runs' mean squared errors.
struct CleanDifference {
  std::string quantity;
  int phase = -1;  ///< -1: of all steps
  double mean = 0.0;
  double se = 0.0;
};

/// a - b, for the quantities that both have, over all steps and by phase. Nothing where no outcome of tracks is known.
std::vector<CleanDifference> clean_differences(const Scorer& scorer_a, const std::vector<const RunScore*>& a,
                                               const Scorer& scorer_b, const std::vector<const RunScore*>& b);

}  // namespace truebearing
