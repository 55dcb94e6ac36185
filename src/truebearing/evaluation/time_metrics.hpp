// Figures at given times, from the scores of a tracker's runs. Their names and definitions are those of the README.
// A run counts at a time that it reaches with a known truth; of these, runs without a finite estimate are left out of
// every figure but `missing_share`, where they are counted, and `loss_rate`, where they are lost.
#pragma once

#include <string>
#include <vector>

#include "truebearing/evaluation/metric.hpp"
#include "truebearing/evaluation/run_score.hpp"

namespace truebearing {

/// scores: [run], of one tracker.
std::vector<Metric> time_metrics(const Scorer& scorer, const std::vector<const RunScore*>& scores,
                                 const ScoringRule& rule);

/// Share of runs and times, of those at which `reference` solved, at which `scores` of another batch estimator came to
/// a cost as low, but for rounding. Nothing where either never solved.
std::vector<Metric> global_minimum_share(const std::vector<const RunScore*>& scores,
                                         const std::vector<const RunScore*>& reference);

/// At one time: mean over runs of the difference of the two trackers' error norms.
struct TimedDifference {
  std::string quantity;
  double time_s = 0.0;
  double mean = 0.0;
  double se = 0.0;
};

/// a - b, for the quantities that both have, over the runs in which both have an estimate.
std::vector<TimedDifference> timed_differences(const Scorer& scorer_a, const std::vector<const RunScore*>& a,
                                               const Scorer& scorer_b, const std::vector<const RunScore*>& b,
                                               const ScoringRule& rule);

}  // namespace truebearing
