#include "truebearing/evaluation/run_score.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "truebearing/core/error.hpp"
#include "truebearing/evaluation/gospa.hpp"
#include "truebearing/evaluation/target_record.hpp"

namespace truebearing {
namespace {

constexpr double kNotScored = std::numeric_limits<double>::quiet_NaN();

void check_target_motion(const Recording& recording) {
  const auto has_sensor = [](const Measurement& measurement) { return measurement.sensor.has_value(); };
  if (!recording.truth_space || !begins_in_plane(*recording.truth_space) ||
      std::none_of(recording.measurements.begin(), recording.measurements.end(), has_sensor))
    throw InputError("scoring.target_motion", "has no own ship to be relative to, or no truth in the plane",
                     "measurements with own-ship columns");
}

// Scores the records of one tracker in one run as they come.
class RunScorer {
 public:
  RunScorer(const Scorer& scorer, const Recording& recording, const ScoringRule& rule)
      : scorer_(scorer), recording_(recording), rule_(rule), matched_(recording.truth.size()) {
    const std::size_t steps = recording.measurements.size(), targets = recording.truth.size();
    scorer.prepare(score_, steps, targets);
    take_phases(steps);
    if (targets == 1) score_.turns_at_s = recording.truth.front().turns_at_s;
    for (const int at : steps_at(recording, rule.times_s)) score_.at_times.push_back({.step = at});
    if (rule.tracks) followed_ = scorer.quantity(rule.tracks->quantity);
    if (followed_) truth_.assign(steps * targets, kNotScored), estimates_ = truth_;
    if (rule.gospa) assigned_ = scorer.quantity(rule.gospa->quantity);
    if (assigned_) score_.gospa.emplace();
  }

  void take(std::size_t step, std::span<const StepRecord> records) {
    match(step, records);
    for (std::size_t target = 0; target < matched_.size(); ++target) {
      const BoundedVector& truth = recording_.truth[target].x[step];
      const std::size_t place = target * recording_.measurements.size() + step;
      if (followed_) truth_[place] = scorer_.true_value(*followed_, truth);
      if (!matched_[target]) continue;
      const StepRecord& record = *matched_[target];
      scorer_.score_step(truth, record, place, score_);
      if (followed_) estimates_[place] = scorer_.estimated_value(*followed_, record.x);
      for (TimeScore& at : score_.at_times)
        if (at.step == static_cast<int>(step))
          at.take(truth, record, recording_.measurements[step].sensor, rule_.target_motion);
    }
  }

  RunScore finish(std::span<const TrackEvent> events) {
    score_.events.assign(events.begin(), events.end());
    if (followed_) score_.tracks = track_outcome(truth_, estimates_, matched_.size(), *rule_.tracks);
    return std::move(score_);
  }

 private:
  void take_phases(std::size_t steps) {
    const std::vector<Truth>& truth = recording_.truth;
    if (truth.size() == 1) score_.phase = truth.front().phase;
    if (truth.size() == 1 || std::all_of(truth.begin(), truth.end(), [](const Truth& t) { return t.phase.empty(); }))
      return;
    for (const Truth& target : truth) {
      score_.phase.insert(score_.phase.end(), target.phase.begin(), target.phase.end());
      score_.phase.resize(score_.phase.size() + steps - target.phase.size(), -1);
    }
  }

  // The record of each target.
  void match(std::size_t step, std::span<const StepRecord> records) {
    if (assigned_) return assign(step, records);
    for (std::size_t target = 0; target < matched_.size(); ++target) {
      const bool is_there = matched_.size() == 1 || !recording_.truth[target].x[step].array().isNaN().all();
      matched_[target] = is_there ? target_record(recording_, target, records) : nullptr;
    }
  }

  void assign(std::size_t step, std::span<const StepRecord> records) {
    std::vector<double> true_values, estimated_values;
    std::vector<std::size_t> targets;
    std::vector<const StepRecord*> tracks;
    for (std::size_t target = 0; target < matched_.size(); ++target) {
      const double value = scorer_.true_value(*assigned_, recording_.truth[target].x[step]);
      if (!std::isfinite(value)) continue;
      true_values.push_back(value);
      targets.push_back(target);
    }
    for (const StepRecord& record : records) {
      const double value = scorer_.estimated_value(*assigned_, record.x);
      if (!std::isfinite(value)) continue;
      estimated_values.push_back(value);
      tracks.push_back(&record);
    }
    const Gospa found = gospa(true_values, estimated_values, rule_.gospa->cutoff);
    std::fill(matched_.begin(), matched_.end(), nullptr);
    for (std::size_t i = 0; i < targets.size(); ++i)
      if (found.track_of[i] >= 0) matched_[targets[i]] = tracks[static_cast<std::size_t>(found.track_of[i])];
    GospaSum& sum = *score_.gospa;
    sum.squared += found.squared(rule_.gospa->cutoff);
    sum.localisation += found.localisation;
    sum.missed += found.missed;
    sum.false_tracks += found.false_tracks;
    sum.steps += 1.0;
  }

  const Scorer& scorer_;
  const Recording& recording_;
  const ScoringRule& rule_;
  RunScore score_;
  std::vector<const StepRecord*> matched_;  // [target], of this step
  std::optional<std::size_t> followed_;     // the quantity of rule.tracks
  std::optional<std::size_t> assigned_;     // the quantity of rule.gospa
  std::vector<double> truth_, estimates_;   // [target * steps + step] of the one that is followed
};

void check_targets(const Recording& recording, const ScoringRule& rule) {
  if (recording.truth.empty()) throw InputError("scoring", "the recording has the truth of 0 targets", "one or more");
  if (recording.truth.size() > 1 && !rule.times_s.empty())
    throw InputError("scoring.times_s",
                     "are of one target, and the recording has " + std::to_string(recording.truth.size()),
                     "no times_s, or a recording of one target");
}

}  // namespace

std::vector<RunScore> score_recording(TrackerSet& trackers, const std::vector<Scorer>& scorers,
                                      const Recording& recording, const ScoringRule& rule) {
  check_targets(recording, rule);
  if (rule.target_motion) check_target_motion(recording);
  std::vector<RunScorer> runs;
  for (const Scorer& scorer : scorers) runs.emplace_back(scorer, recording, rule);

  trackers.reset();
  for (std::size_t step = 0; step < recording.measurements.size(); ++step) {
    trackers.step(recording.measurements[step]);
    if (static_cast<int>(step) + 1 < rule.from_step) continue;
    for (std::size_t i = 0; i < runs.size(); ++i) runs[i].take(step, trackers.records(static_cast<int>(i)));
  }
  std::vector<RunScore> scores;
  for (std::size_t i = 0; i < runs.size(); ++i) scores.push_back(runs[i].finish(trackers.events(static_cast<int>(i))));
  return scores;
}

}  // namespace truebearing
