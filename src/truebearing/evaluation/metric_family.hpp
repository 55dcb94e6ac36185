// SPDX-License-Identifier: Apache-2.0
// MetricFamily: figures that belong together, over the runs of one tracker. What it needs of a run beside its RunScore
// it gathers step by step, run by run; a tally takes the runs in the order of their numbers, so that the order in which
// they were computed cannot matter, and keeps no more of them than its figures need. A new one is a file of its own and a line in metric_registry.cpp.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "truebearing/evaluation/gospa.hpp"
#include "truebearing/evaluation/metric.hpp"
#include "truebearing/evaluation/scorer.hpp"
#include "truebearing/evaluation/tally_stream.hpp"
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
  /// After the last step, with what the tracker reported since the first.
  virtual void end(std::span<const TrackEvent>) {}
};

/// What is gathered step by step.
class StepFigures : public RunFigures {
 public:
  virtual void take(const ScoredStep&) {}
};

/// What a family makes of the runs of one tracker: they are added in the order of their numbers, and gone afterwards.
class MetricTally {
 public:
  virtual ~MetricTally() = default;
  virtual void add(const RunScore& run) = 0;
  /// Writes all that it has kept, or adds that of the runs that come next.
  virtual void exchange(TallyStream& stream) = 0;
  /// The figures: name, unit and, of those at the rule's times, time. Empty where the tracker has none.
  virtual std::vector<Metric> metrics() const = 0;
};

/// The same of two trackers a and b over the same runs: a - b, for what both have.
class PairTally {
 public:
  virtual ~PairTally() = default;
  virtual void add(const RunScore& a, const RunScore& b) = 0;
  virtual void exchange(TallyStream& stream) = 0;
  virtual std::vector<PairedDifference> differences() const = 0;
};

class MetricFamily {
 public:
  virtual ~MetricFamily() = default;

  /// To be filled over a run; nullptr where RunScore has all that a tally needs. Throws InputError where the recording
  /// cannot be scored so.
  virtual std::unique_ptr<RunFigures> begin(const RunStart&) const { return nullptr; }
  /// Of a tracker with that scorer; both must outlive it.
  virtual std::unique_ptr<MetricTally> tally(const ScoringRule& rule, const Scorer& scorer) const = 0;
  /// nullptr where the family compares nothing.
  virtual std::unique_ptr<PairTally> pair_tally(const ScoringRule&, const Scorer& /*a*/, const Scorer& /*b*/) const {
    return nullptr;
  }
};

/// Families that have something to say of any study: figures at its times, of batch estimators, of events.
std::vector<std::shared_ptr<const MetricFamily>> usual_metrics();

/// All families of a rule. Figures at times come first, in the order of the times.
class MetricTallies final : public MetricTally {
 public:
  MetricTallies(const ScoringRule& rule, const Scorer& scorer);
  void add(const RunScore& run) override;
  void exchange(TallyStream& stream) override;
  std::vector<Metric> metrics() const override;

 private:
  std::vector<std::unique_ptr<MetricTally>> tallies_;
};

class PairTallies final : public PairTally {
 public:
  PairTallies(const ScoringRule& rule, const Scorer& a, const Scorer& b);
  void add(const RunScore& a, const RunScore& b) override;
  void exchange(TallyStream& stream) override;
  std::vector<PairedDifference> differences() const override;

 private:
  std::vector<std::unique_ptr<PairTally>> tallies_;
};

}  // namespace truebearing
