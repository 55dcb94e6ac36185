// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/run_score.hpp"

#include <algorithm>
#include <cmath>

#include "truebearing/core/error.hpp"
#include "truebearing/evaluation/step_through.hpp"
#include "truebearing/evaluation/target_record.hpp"
#include "truebearing/evaluation/time_steps.hpp"

namespace truebearing {
namespace {

// Scores the records of one tracker in one run as they come.
class RunScorer {
 public:
  RunScorer(const Scorer& scorer, const Recording& recording, const ScoringRule& rule)
      : scorer_(scorer),
        recording_(recording),
        rule_(rule),
        columns_(scorer.dimension()),
        matched_(recording.truth.size()) {
    const std::size_t steps = recording.measurements.size(), targets = recording.truth.size();
    scorer.prepare(score_, steps, targets);
    take_phases(steps);
    score_.time_steps = steps_at(recording, rule.times_s);
    for (const std::shared_ptr<const MetricFamily>& family : rule.families)
      if (auto figures = family->begin({rule, scorer, recording, score_.time_steps})) {
        if (auto* gathered = dynamic_cast<StepFigures*>(figures.get())) gathered_.push_back(gathered);
        figures_.push_back(std::move(figures));
      }
    if (rule.assignment) assigned_ = scorer.quantity(rule.assignment->quantity);
  }

  void take(std::size_t step, std::span<const StepRecord> records) {
    match(step, records);
    for (std::size_t target = 0; target < matched_.size(); ++target)
      if (matched_[target])
        scorer_.score_step(recording_.truth[target].x[step], *matched_[target],
                           target * recording_.measurements.size() + step, columns_, score_);
    for (StepFigures* const figures : gathered_) figures->take({step, matched_, assigned_ ? &assignment_ : nullptr});
  }

  RunScore finish(std::span<const TrackEvent> events) {
    scorer_.score_together(columns_, score_);
    for (std::unique_ptr<RunFigures>& figures : figures_) {
      figures->end(events);
      score_.figures.push_back(std::move(figures));
    }
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
    assignment_ = gospa(true_values, estimated_values, rule_.assignment->cutoff);
    std::fill(matched_.begin(), matched_.end(), nullptr);
    for (std::size_t i = 0; i < targets.size(); ++i)
      if (const int track = assignment_.track_of[i]; track >= 0)
        matched_[targets[i]] = tracks[static_cast<std::size_t>(track)];
  }

  const Scorer& scorer_;
  const Recording& recording_;
  const ScoringRule& rule_;
  RunScore score_;
  StepColumns columns_;  // of the steps that are not yet scored
  std::vector<std::unique_ptr<RunFigures>> figures_;
  std::vector<StepFigures*> gathered_;      // those of them that look at every step
  std::vector<const StepRecord*> matched_;  // [target], of this step
  std::optional<std::size_t> assigned_;     // the quantity of rule.assignment
  Gospa assignment_;                        // of this step, where there is one
};

void check_targets(const Recording& recording, const ScoringRule& rule) {
  if (recording.truth.empty()) throw InputError("scoring", "the recording has the truth of 0 targets", "one or more");
  if (recording.truth.size() > 1 && !rule.times_s.empty())
    throw InputError("scoring.times_s",
                     "are of one target, and the recording has " + std::to_string(recording.truth.size()),
                     "no times_s, or a recording of one target");
}

// Scores all trackers in one run.
class RunsScorer {
 public:
  RunsScorer(const std::vector<Scorer>& scorers, const Recording& recording, const ScoringRule& rule) : rule_(rule) {
    check_targets(recording, rule);
    for (const Scorer& scorer : scorers) runs_.emplace_back(scorer, recording, rule);
  }

  // False where that step is not scored.
  bool take(std::size_t step, const TrackerSet& trackers) {
    if (static_cast<int>(step) + 1 < rule_.from_step) return false;
    for (std::size_t i = 0; i < runs_.size(); ++i) runs_[i].take(step, trackers.records(static_cast<int>(i)));
    return true;
  }

  std::vector<RunScore> finish(const TrackerSet& trackers) {
    std::vector<RunScore> scores;
    for (std::size_t i = 0; i < runs_.size(); ++i)
      scores.push_back(runs_[i].finish(trackers.events(static_cast<int>(i))));
    return scores;
  }

 private:
  const ScoringRule& rule_;
  std::vector<RunScorer> runs_;
};

}  // namespace

std::vector<RunScore> score_recording(TrackerSet& trackers, const std::vector<Scorer>& scorers,
                                      const Recording& recording, const ScoringRule& rule,
                                      const std::function<void(std::size_t step)>& scored) {
  RunsScorer runs(scorers, recording, rule);
  trackers.reset();
  trackers.foresee(recording.measurements);
  for (std::size_t step = 0; step < recording.measurements.size(); ++step) {
    trackers.step(recording.measurements[step]);
    if (runs.take(step, trackers) && scored) scored(step);
  }
  return runs.finish(trackers);
}

std::vector<std::vector<RunScore>> score_recordings(
    TrackerSetPack& trackers, const std::vector<Scorer>& scorers, std::span<const Recording* const> recordings,
    const ScoringRule& rule, const std::function<void(std::size_t recording, std::size_t step)>& scored) {
  std::vector<RunsScorer> runs;
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    runs.emplace_back(scorers, *recordings[i], rule);
    trackers.set(i).reset();
    trackers.set(i).foresee(recordings[i]->measurements);
  }
  step_through(trackers, recordings, [&](std::size_t i, std::size_t step) {
    if (runs[i].take(step, trackers.set(i)) && scored) scored(i, step);
  });
  std::vector<std::vector<RunScore>> scores;
  for (std::size_t i = 0; i < recordings.size(); ++i) scores.push_back(runs[i].finish(trackers.set(i)));
  return scores;
}

}  // namespace truebearing
