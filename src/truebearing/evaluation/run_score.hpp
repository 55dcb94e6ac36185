// RunScore: the errors of one tracker in one run, step by step. Everything that a comparison reports is made from
// these, so that the order in which runs were computed cannot matter.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "truebearing/evaluation/time_score.hpp"
#include "truebearing/evaluation/tracker_set.hpp"
#include "truebearing/measurement/recording.hpp"

namespace truebearing {

struct RunScore {
  std::vector<std::vector<double>> error;  ///< [quantity][step]: 2-norm of truth - estimate; NaN where not scored
  std::vector<double> nees;                ///< [step]: d' P^-1 d; NaN where not scored
  std::vector<std::vector<double>> quantity_nees;  ///< [quantity][step]: the same for its components alone
  std::vector<int> phase;                          ///< [step], place in the recording's phases; empty where it has none
  int gate_limited = 0;                            ///< scored steps in which a correction was limited by kappa
  int corrected = 0;                               ///< scored steps of a corrected tracker
  double gate_sum = 0.0;                           ///< sum of the gate's weight over them
  std::vector<TimeScore> at_times;                 ///< [time] of ScoringRule::times_s
  std::vector<TrackEvent> events;                  ///< that the tracker reported by the end of the run
  std::optional<double> turns_at_s;                ///< of the truth (measurement/recording.hpp)
};

/// What is scored.
struct ScoringRule {
  int from_step = 1;  ///< number of the first scored measurement, counted from 1
  /// A run is lost where the last scored error of a quantity passes its threshold.
  std::vector<std::pair<std::string, double>> loss_thresholds;
  std::vector<double> times_s = {};  ///< at which figures are given besides, ascending
  bool target_motion = false;        ///< and errors in range, course and speed with them
};

/// Where the components and quantities of a tracker's state are found in the truth; by name.
class Scorer {
 public:
  Scorer(const StateSpace& truth, const StateSpace& estimate);

  const StateSpace& truth() const { return *truth_; }
  /// The truth's quantities that the tracker estimates.
  const std::vector<std::string>& quantities() const { return quantity_names_; }
  /// How many components the NEES is taken over: its expected value for a consistent tracker.
  int dimension() const { return static_cast<int>(truth_index_.size()); }
  /// The same for one quantity.
  int dimension(std::size_t quantity) const { return static_cast<int>(quantities_[quantity].size()); }

  void prepare(RunScore& score, std::size_t steps) const;
  void score_step(const BoundedVector& truth, const StepRecord& record, std::size_t step, RunScore& score) const;

 private:
  const StateSpace* truth_;
  std::vector<int> truth_index_;     // of each component that both have
  std::vector<int> estimate_index_;  // its place in the estimate
  std::vector<std::string> quantity_names_;
  std::vector<std::vector<int>> quantities_;  // places in the two lists above
};

/// Runs the trackers over a recording with the truth of one target and scores each. The set is reset first.
std::vector<RunScore> score_recording(TrackerSet& trackers, const std::vector<Scorer>& scorers,
                                      const Recording& recording, const ScoringRule& rule);

}  // namespace truebearing
