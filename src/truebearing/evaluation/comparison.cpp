// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/comparison.hpp"

#include <algorithm>
#include <chrono>
#include <optional>
#include <utility>

#include "truebearing/core/error.hpp"
#include "truebearing/evaluation/batch_metrics.hpp"
#include "truebearing/evaluation/time_steps.hpp"

namespace truebearing {

namespace {

using BoundAtTimes = std::vector<TargetMotionVariance>;  // [time]

// What one run gives.
struct RunOutcome {
  std::vector<RunScore> scores;  // [tracker]
  BoundAtTimes bound;            // where the options ask for them
  AngleVariances angle_bound;
  std::vector<std::optional<CorrectionTally>> corrections;  // [tracker], where the options ask for details
};

std::vector<std::optional<CorrectionTally>> correction_tallies(const TrackerSet& trackers) {
  std::vector<std::optional<CorrectionTally>> tallies(static_cast<std::size_t>(trackers.size()));
  for (int i = 0; i < trackers.size(); ++i)
    if (const Correction* correction = trackers.correction(i))
      tallies[static_cast<std::size_t>(i)].emplace(*correction);
  return tallies;
}

std::size_t index_of(const TrackerSet& trackers, const std::string& name) {
  for (int i = 0; i < trackers.size(); ++i)
    if (trackers.name(i) == name) return static_cast<std::size_t>(i);
  throw InputError("scoring", "there is no tracker \"" + name + "\" in this comparison");
}

// The figures of runs that are added in the order of their numbers, and gone afterwards.
class ComparisonTally {
 public:
  // kept_apart: as for SummaryTally. All but the trackers must outlive it.
  ComparisonTally(const TrackerSet& trackers, const std::vector<Scorer>& scorers, const ComparisonOptions& options,
                  std::size_t kept_apart, bool details)
      : options_(options) {
    for (std::size_t i = 0; i < scorers.size(); ++i) {
      const std::string& name = trackers.name(static_cast<int>(i));
      trackers_.push_back({SummaryTally(name, scorers[i], options.scoring, kept_apart),
                           MetricTallies(options.scoring, scorers[i]),
                           {}});
      if (details) details_.emplace_back(scorers[i].dimension());
    }
    if (options.details) corrections_ = correction_tallies(trackers);
    if (!options.global_minimum.empty()) global_minimum_ = index_of(trackers, options.global_minimum);
    for (const auto& [a, b] : options.pairs) {
      const std::size_t ia = index_of(trackers, a), ib = index_of(trackers, b);
      pairs_.push_back(
          {ia, ib, DifferenceTally(scorers[ia], scorers[ib]), PairTallies(options.scoring, scorers[ia], scorers[ib])});
    }
  }

  void add(const RunOutcome& run) {
    for (std::size_t i = 0; i < trackers_.size(); ++i) {
      trackers_[i].summary.add(run.scores[i]);
      trackers_[i].metrics.add(run.scores[i]);
      if (!details_.empty()) details_[i].add(run.scores[i]);
      if (!corrections_.empty() && corrections_[i]) corrections_[i]->add(*run.corrections[i]);
      if (global_minimum_ && *global_minimum_ != i)
        trackers_[i].global_minimum.add(run.scores[i], run.scores[*global_minimum_]);
    }
    for (Pair& pair : pairs_) {
      pair.rmse.add(run.scores[pair.a], run.scores[pair.b]);
      pair.metrics.add(run.scores[pair.a], run.scores[pair.b]);
    }
    if (options_.cramer_rao) bound_.add(run.bound);
    if (options_.angle_bound) angle_bound_.add(run.angle_bound);
  }

  Comparison comparison() const {
    Comparison comparison;
    comparison.seed = options_.seed;
    comparison.runs = options_.runs;
    comparison.bounds = options_.bounds;
    if (options_.angle_bound) comparison.angle_bounds = angle_bound_.summaries();
    if (options_.cramer_rao) comparison.cramer_rao = bound_.summary(options_.scoring.times_s);
    for (const OfTracker& tracker : trackers_) {
      TrackerSummary& summary = comparison.trackers.emplace_back(tracker.summary.summary());
      const auto add_metrics = [&](const std::vector<Metric>& metrics) {
        summary.metrics.insert(summary.metrics.end(), metrics.begin(), metrics.end());
      };
      add_metrics(tracker.metrics.metrics());
      if (options_.cramer_rao) add_metrics(range_efficiency(summary.metrics, comparison.cramer_rao->metrics));
      add_metrics(tracker.global_minimum.metrics());
    }
    for (const DetailsTally& tally : details_) comparison.details.push_back(tally.details());
    for (const std::optional<CorrectionTally>& tally : corrections_) {
      comparison.corrections.emplace_back();
      if (tally) comparison.corrections.back() = tally->details();
    }
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      const auto& [a, b] = options_.pairs[i];
      Comparison::Pair& pair = comparison.pairs.emplace_back(Comparison::Pair{a, b, pairs_[i].rmse.differences()});
      for (PairedDifference& difference : pairs_[i].metrics.differences())
        pair.differences.push_back(std::move(difference));
    }
    return comparison;
  }

 private:
  struct OfTracker {
    SummaryTally summary;
    MetricTallies metrics;
    GlobalMinimumTally global_minimum;
  };
  struct Pair {
    std::size_t a, b;
    DifferenceTally rmse;
    PairTallies metrics;
  };
  const ComparisonOptions& options_;
  std::vector<OfTracker> trackers_;
  std::vector<DetailsTally> details_;                        // [tracker], or empty
  std::vector<std::optional<CorrectionTally>> corrections_;  // likewise
  std::optional<std::size_t> global_minimum_;
  std::vector<Pair> pairs_;
  BoundTally bound_;
  AngleBoundTally angle_bound_;
};

// Runs the trackers on the runs of one scenario, some at a time, and gives each run to `take` in the order of their
// numbers: no more than those few are ever there.
class SetOfRuns {
 public:
  SetOfRuns(const TrackerSet& trackers, const std::vector<Scorer>& scorers, const Scenario& scenario,
            const ComparisonOptions& options)
      : trackers_(trackers),
        scorers_(scorers),
        scenario_(scenario),
        options_(options),
        copies_(worker_count(options.threads)) {}

  // progress: of the runs of this set.
  template <typename Take>
  void run(const Progress& progress, const Take& take) {
    const std::size_t at_a_time = 16 * copies_.size();
    for (std::size_t first = 0; first < options_.runs; first += at_a_time) {
      std::vector<RunOutcome> outcomes(std::min(at_a_time, options_.runs - first));
      Progress of_all;
      if (progress) of_all = [&](std::size_t done, std::size_t) { progress(first + done, options_.runs); };
      monte_carlo(
          outcomes.size(), options_.threads,
          [&](std::size_t run, std::size_t worker) { outcomes[run] = outcome(first + run, worker); }, of_all);
      for (const RunOutcome& outcome : outcomes) take(outcome);
    }
  }

  // Of the first run.
  const std::vector<double>& time_s() const { return time_s_; }
  const std::vector<std::string>& phases() const { return phases_; }

 private:
  RunOutcome outcome(std::size_t run, std::size_t worker) {
    std::optional<TrackerSet>& copy = copies_[worker];
    if (!copy) copy.emplace(trackers_.fresh());
    const Recording recording = scenario_.simulate({options_.seed, options_.role, run});
    RunOutcome outcome;
    if (options_.details) {
      outcome.corrections = correction_tallies(*copy);
      outcome.scores = score_recording(*copy, scorers_, recording, options_.scoring, [&](std::size_t step) {
        for (std::size_t i = 0; i < outcome.corrections.size(); ++i)
          if (outcome.corrections[i])
            outcome.corrections[i]->take(step, copy->records(static_cast<int>(i)),
                                         copy->correction(static_cast<int>(i))->accounts());
      });
    } else {
      outcome.scores = score_recording(*copy, scorers_, recording, options_.scoring);
    }
    if (options_.cramer_rao)
      outcome.bound = options_.cramer_rao->variances(recording, steps_at(recording, options_.scoring.times_s));
    if (options_.angle_bound)
      outcome.angle_bound = options_.angle_bound->variances(recording, options_.scoring.from_step);
    if (run != 0) return outcome;
    for (const Measurement& measurement : recording.measurements) time_s_.push_back(measurement.time_s);
    phases_ = recording.phases;
    return outcome;
  }

  const TrackerSet& trackers_;
  const std::vector<Scorer>& scorers_;
  const Scenario& scenario_;
  const ComparisonOptions& options_;
  std::vector<std::optional<TrackerSet>> copies_;  // [worker]
  std::vector<double> time_s_;
  std::vector<std::string> phases_;
};

}  // namespace

const TrackerSummary* Comparison::tracker(const std::string& name) const {
  for (const TrackerSummary& summary : trackers)
    if (summary.name == name) return &summary;
  return nullptr;
}

Comparison compare(const TrackerSet& trackers, const std::vector<NamedScenario>& scenarios,
                   const ComparisonOptions& options) {
  std::vector<Scorer> scorers;
  for (int i = 0; i < trackers.size(); ++i)
    scorers.emplace_back(scenarios.front().scenario->truth_space(), trackers.space(i));

  std::size_t medians = 0;  // at a time: of all sets, and of one
  for (const Scorer& scorer : scorers) medians += (scenarios.size() > 1 ? 2 : 1) * scorer.quantities().size();
  const std::size_t kept_apart = kMostValuesApart / std::max<std::size_t>(medians, 1);
  ComparisonTally all(trackers, scorers, options, kept_apart, options.details);
  std::vector<ComparisonOfSet> sets;
  std::vector<double> time_s;
  std::vector<std::string> phases;
  for (std::size_t i = 0; i < scenarios.size(); ++i) {
    SetOfRuns set(trackers, scorers, *scenarios[i].scenario, options);
    Progress progress;
    if (options.progress)
      progress = [&](std::size_t done, std::size_t) {
        options.progress(i * options.runs + done, scenarios.size() * options.runs);
      };
    ComparisonTally alone(trackers, scorers, options, kept_apart, false);
    set.run(progress, [&](const RunOutcome& run) {
      all.add(run);
      if (scenarios.size() > 1) alone.add(run);
    });
    if (i == 0) time_s = set.time_s();
    if (i == 0) phases = set.phases();
    if (scenarios.size() < 2) continue;
    sets.push_back({scenarios[i].name, alone.comparison()});
    sets.back().comparison.time_s = set.time_s();
    sets.back().comparison.phases = set.phases();
    sets.back().comparison.published = published_of(options.published, scenarios[i].name);
  }
  Comparison comparison = all.comparison();
  comparison.time_s = std::move(time_s);
  comparison.phases = std::move(phases);
  comparison.sets = std::move(sets);
  comparison.published = published_of(options.published, {});
  return comparison;
}

double time_per_step_ns(Tracker& tracker, const Recording& recording) {
  using Clock = std::chrono::steady_clock;
  constexpr int kPasses = 5;
  std::vector<double> passes;
  for (int pass = 0; pass < kPasses; ++pass) {
    tracker.reset();
    const auto begin = Clock::now();
    tracker.foresee(recording.measurements);
    for (const Measurement& measurement : recording.measurements) tracker.step(measurement);
    const std::chrono::duration<double, std::nano> elapsed = Clock::now() - begin;
    passes.push_back(elapsed.count() / static_cast<double>(std::max<std::size_t>(recording.measurements.size(), 1)));
  }
  std::sort(passes.begin(), passes.end());
  return passes[kPasses / 2];
}

}  // namespace truebearing
