// SPDX-License-Identifier: Apache-2.0
// A comparison: trackers on the same Monte Carlo runs of one scenario, scored against the truth.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "truebearing/evaluation/angle_bound_summary.hpp"
#include "truebearing/evaluation/bound_summary.hpp"
#include "truebearing/evaluation/comparison_details.hpp"
#include "truebearing/evaluation/correction_details.hpp"
#include "truebearing/evaluation/monte_carlo.hpp"
#include "truebearing/evaluation/published.hpp"
#include "truebearing/evaluation/summary.hpp"
#include "truebearing/simulation/scenario.hpp"

namespace truebearing {

struct ComparisonOptions {
  std::uint64_t seed = 1;
  Role role = Role::evaluation;
  std::size_t runs = 1000;
  int threads = 0;  ///< 0: one per core
  ScoringRule scoring;
  std::vector<std::pair<std::string, std::string>> pairs;  ///< "a - b" for each
  std::vector<std::string> bounds;                         ///< trackers that are bounds: reported as such too
  std::optional<TargetMotionBound> cramer_rao;             ///< at the times of the scoring
  std::optional<AngleBound> angle_bound;                   ///< of several targets at a line array
  std::string global_minimum;           ///< the batch tracker whose costs the others' are compared with; or empty
  std::vector<PublishedRow> published;  ///< of others, to stand beside the figures
  bool details = false;                 ///< keep what plots need besides
  Progress progress;
};

struct ComparisonOfSet;

struct Comparison {
  std::string study;
  std::uint64_t seed = 0;
  std::size_t runs = 0;
  std::vector<double> time_s;       ///< of the steps, in the first run
  std::vector<std::string> phases;  ///< names of the phases that the scenario tells apart
  std::vector<TrackerSummary> trackers;
  std::vector<TrackerDetails> details;  ///< [tracker], over all sets; empty where the options do not ask for them
  /// [tracker]; nothing of what is no correction, empty where the options do not ask for them
  std::vector<std::optional<CorrectionDetails>> corrections;
  struct Pair {
    std::string a, b;
    std::vector<PairedDifference> differences;  ///< of the RMSE; then of the metric families
  };
  std::vector<Pair> pairs;
  std::vector<std::string> bounds;
  std::optional<BoundSummary> cramer_rao;
  std::vector<AngleBoundSummary> angle_bounds;              ///< where the options ask for them
  std::vector<std::pair<std::string, double>> ns_per_step;  ///< by tracker; timings, the only figures that vary
  std::vector<PublishedRow> published;                      ///< of others, of the same
  std::vector<ComparisonOfSet> sets;                        ///< where there were several: each by itself

  const TrackerSummary* tracker(const std::string& name) const;
};

struct ComparisonOfSet {
  std::string name;
  Comparison comparison;
};

struct NamedScenario {
  std::string name;
  const Scenario* scenario;
};

/// Runs the trackers on `runs` evaluation runs of each scenario. With several, the figures are those over all of them
/// together and `sets` has each by itself. The same for any number of threads.
Comparison compare(const TrackerSet& trackers, const std::vector<NamedScenario>& scenarios,
                   const ComparisonOptions& options);

/// Median time of a step of one tracker over `recording`, in nanoseconds.
double time_per_step_ns(Tracker& tracker, const Recording& recording);

}  // namespace truebearing
