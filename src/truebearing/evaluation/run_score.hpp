// RunScore: the errors of one tracker in one run, target by target and step by step. Everything that a comparison
// reports is made from these, so that the order in which runs were computed cannot matter.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "truebearing/evaluation/scorer.hpp"
#include "truebearing/evaluation/time_score.hpp"
#include "truebearing/evaluation/track_outcome.hpp"
#include "truebearing/evaluation/tracker_set.hpp"
#include "truebearing/recording/recording.hpp"

namespace truebearing {

/// The GOSPA of a run's scored steps (gospa.hpp), summed.
struct GospaSum {
  double squared = 0.0;
  double localisation = 0.0;
  double missed = 0.0;
  double false_tracks = 0.0;
  double steps = 0.0;
};

/// [place]: one target after another, the steps of each in turn, target * steps() + step.
struct RunScore {
  std::size_t targets = 1;
  std::vector<std::vector<double>> error;  ///< [quantity][place]: 2-norm of truth - estimate; NaN where not scored
  std::vector<double> nees;                ///< [place]: d' P^-1 d; NaN where not scored
  std::vector<std::vector<double>> quantity_nees;  ///< [quantity][place]: the same for its components alone
  std::vector<int> phase;              ///< [place], place in the recording's phases; empty where it has none
  int gate_limited = 0;                ///< scored steps in which a correction was limited by kappa
  int corrected = 0;                   ///< scored steps of a corrected tracker
  double gate_sum = 0.0;               ///< sum of the gate's weight over them
  std::vector<TimeScore> at_times;     ///< [time] of ScoringRule::times_s
  std::vector<TrackEvent> events;      ///< that the tracker reported by the end of the run
  std::optional<double> turns_at_s;    ///< of the truth (recording/recording.hpp), where there is one target
  std::optional<TrackOutcome> tracks;  ///< where ScoringRule::tracks asks for it
  std::optional<GospaSum> gospa;       ///< where ScoringRule::gospa asks for it

  std::size_t steps() const { return error.empty() ? 0 : error.front().size() / targets; }
};

struct GospaRule {
  std::string quantity;  ///< of one component: "angle_deg"
  double cutoff = 0.0;   ///< in its unit
};

/// What is scored.
struct ScoringRule {
  int from_step = 1;  ///< number of the first scored measurement, counted from 1
  /// A run is lost where the last scored error of a quantity passes its threshold.
  std::vector<std::pair<std::string, double>> loss_thresholds;
  std::vector<double> times_s = {};                ///< at which figures are given besides, ascending
  bool target_motion = false;                      ///< and errors in range, course and speed with them
  std::optional<TrackRule> tracks = std::nullopt;  ///< swaps and losses of several targets
  /// Where given, records belong to targets not by the number of the track but by the assignment of each step.
  std::optional<GospaRule> gospa = std::nullopt;
};

/// Runs the trackers over a recording with the truth of one target or several and scores each. A record is scored
/// against the target of its track (target_record.hpp), or the one it is assigned to. The set is reset first.
std::vector<RunScore> score_recording(TrackerSet& trackers, const std::vector<Scorer>& scorers,
                                      const Recording& recording, const ScoringRule& rule);

}  // namespace truebearing
