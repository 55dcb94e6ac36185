// SPDX-License-Identifier: Apache-2.0
// RunScore: the errors of one tracker in one run, target by target and step by step, and what the metric families keep
// of it. Everything that a comparison reports is made from these, so that the order in which runs were computed cannot
// matter.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "truebearing/evaluation/metric_family.hpp"
#include "truebearing/evaluation/scorer.hpp"
#include "truebearing/evaluation/tracker_set.hpp"
#include "truebearing/recording/recording.hpp"

namespace truebearing {

/// [place]: one target after another, the steps of each in turn, target * steps() + step.
struct RunScore {
  std::size_t targets = 1;
  std::vector<std::vector<double>> error;  ///< [quantity][place]: 2-norm of truth - estimate; NaN where not scored
  std::vector<double> nees;                ///< [place]: d' P^-1 d; NaN where not scored
  std::vector<std::vector<double>> quantity_nees;  ///< [quantity][place]: the same for its components alone
  std::vector<int> phase;       ///< [place], place in the recording's phases; empty where it has none
  int gate_limited = 0;         ///< scored steps in which a correction was limited by kappa
  int corrected = 0;            ///< scored steps of a corrected tracker
  double gate_sum = 0.0;        ///< sum of the gate's weight over them
  std::vector<int> time_steps;  ///< [time] of ScoringRule::times_s: the step that stands for it (time_steps.hpp)
  std::vector<std::shared_ptr<const RunFigures>> figures;  ///< of ScoringRule::families, of those that keep any

  std::size_t steps() const { return error.empty() ? 0 : error.front().size() / targets; }
  /// Place in the recording's phases, -1 where it tells none.
  int phase_at(std::size_t place) const { return place < phase.size() ? phase[place] : -1; }

  /// Those figures that are of a type; nullptr where there are none.
  template <typename Figures>
  const Figures* of() const {
    for (const std::shared_ptr<const RunFigures>& kept : figures)
      if (const auto* found = dynamic_cast<const Figures*>(kept.get())) return found;
    return nullptr;
  }
};

/// Records belong to targets by the assignment of each step that has the least GOSPA (gospa.hpp).
struct AssignmentRule {
  std::string quantity;  ///< of one component: "angle_deg"
  double cutoff = 0.0;   ///< in its unit
};

/// What is scored.
struct ScoringRule {
  int from_step = 1;  ///< number of the first scored measurement, counted from 1
  /// A run is lost where the last scored error of a quantity passes its threshold.
  std::vector<std::pair<std::string, double>> loss_thresholds;
  std::vector<double> times_s = {};  ///< at which figures are given besides, ascending
  /// Where given, records belong to targets not by the number of the track.
  std::optional<AssignmentRule> assignment = std::nullopt;
  std::vector<std::shared_ptr<const MetricFamily>> families = usual_metrics();
};

/// Runs the trackers over a recording with the truth of one target or several and scores each. A record is scored
/// against the target of its track (target_record.hpp), or the one it is assigned to. The set is reset first. scored:
/// called after each scored step, while the set has its records.
std::vector<RunScore> score_recording(TrackerSet& trackers, const std::vector<Scorer>& scorers,
                                      const Recording& recording, const ScoringRule& rule,
                                      const std::function<void(std::size_t step)>& scored = {});

/// The same of several recordings at once, each by a copy of the set: [recording][tracker]. At most as many as the pack
/// has copies. scored: called with the recording and the step.
std::vector<std::vector<RunScore>> score_recordings(
    TrackerSetPack& trackers, const std::vector<Scorer>& scorers, std::span<const Recording* const> recordings,
    const ScoringRule& rule, const std::function<void(std::size_t recording, std::size_t step)>& scored = {});

}  // namespace truebearing
