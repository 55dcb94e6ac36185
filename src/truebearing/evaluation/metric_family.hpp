// MetricFamily: figures that belong together, over the runs of one tracker. What it needs of a run beside its RunScore
// it gathers step by step, run by run; the figures are made of all runs in the order of their numbers, so that the
// order in which runs were computed cannot matter. A new one is a file of its own and a line in metric_registry.cpp.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "truebearing/evaluation/gospa.hpp"
#include "truebearing/evaluation/metric.hpp"
#include "truebearing/evaluation/scorer.hpp"
#include "truebearing/recording/recording.hpp"
#include "truebearing/tracker/tracker.hpp"

namespace truebearing {

struct RunScore;
struct ScoringRule;

/// A run that begins, of one tracker.
struct RunStart {
  const ScoringRule& rule;
  const Scorer& scorer;
  const Recording& recording;
  const std::vector<int>& time_steps;  ///< [time] of the rule's times_s (time_steps.hpp)
};

/// A step that is scored.
struct ScoredStep {
  std::size_t step;
  std::span<const StepRecord* const> records;  ///< [target]: the record about it, nullptr where there is none
  const Gospa* assignment;                     ///< of records to targets, where the rule assigns them, else nullptr
};

/// What a family keeps of one tracker's run.
class RunFigures {
 public:
  virtual ~RunFigures() = default;
  virtual void take(const ScoredStep&) {}
  /// After the last step, with what the tracker reported since the first.
  virtual void end(std::span<const TrackEvent>) {}
};

/// The runs of one tracker, in the order of their numbers.
struct TrackerRuns {
  const ScoringRule& rule;
  const Scorer& scorer;
  const std::vector<const RunScore*>& scores;
};

class MetricFamily {
 public:
  virtual ~MetricFamily() = default;

  /// To be filled over a run; nullptr where RunScore has all that finish() needs. Throws InputError where the recording
  /// cannot be scored so.
  virtual std::unique_ptr<RunFigures> begin(const RunStart&) const { return nullptr; }
  /// The figures: name, unit and, of those at the rule's times, time. Empty where the tracker has none.
  virtual std::vector<Metric> finish(const TrackerRuns& runs) const = 0;
  /// a - b, for what both have.
  virtual std::vector<PairedDifference> paired(const TrackerRuns& /*a*/, const TrackerRuns& /*b*/) const { return {}; }
};

/// Families that have something to say of any study: figures at its times, of batch estimators, of events.
std::vector<std::shared_ptr<const MetricFamily>> usual_metrics();

/// The figures of all families of the rule: those at times first, in the order of the times.
std::vector<Metric> metrics_of(const TrackerRuns& runs);
/// a - b of all families of the rule.
std::vector<PairedDifference> paired_differences(const TrackerRuns& a, const TrackerRuns& b);

}  // namespace truebearing
