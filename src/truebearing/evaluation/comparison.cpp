#include "truebearing/evaluation/comparison.hpp"

#include <algorithm>
#include <chrono>
#include <optional>
#include <span>
#include <utility>

#include "truebearing/core/error.hpp"
#include "truebearing/evaluation/batch_metrics.hpp"
#include "truebearing/evaluation/time_steps.hpp"

namespace truebearing {

namespace {

using BoundAtTimes = std::vector<TargetMotionVariance>;  // [time]

struct SetScores {
  std::vector<std::vector<RunScore>> runs;  // [run][tracker]
  std::vector<BoundAtTimes> bound;          // [run], or empty
  std::vector<AngleVariances> angle_bound;  // the same
  std::vector<double> time_s;               // of the first run
  std::vector<std::string> phases;
};

SetScores run_set(const TrackerSet& trackers, const std::vector<Scorer>& scorers,
                  const std::vector<NamedScenario>& scenarios, std::size_t index, const ComparisonOptions& options) {
  const Scenario& scenario = *scenarios[index].scenario;
  SetScores set;
  set.runs.resize(options.runs);
  if (options.cramer_rao) set.bound.resize(options.runs);
  if (options.angle_bound) set.angle_bound.resize(options.runs);
  std::vector<std::optional<TrackerSet>> copies(worker_count(options.threads));
  const auto run_one = [&](std::size_t run, std::size_t worker) {
    if (!copies[worker]) copies[worker].emplace(trackers.fresh());
    const Recording recording = scenario.simulate({options.seed, options.role, run});
    set.runs[run] = score_recording(*copies[worker], scorers, recording, options.scoring);
    if (options.cramer_rao)
      set.bound[run] = options.cramer_rao->variances(recording, steps_at(recording, options.scoring.times_s));
    if (options.angle_bound)
      set.angle_bound[run] = options.angle_bound->variances(recording, options.scoring.from_step);
    if (run != 0) return;
    for (const Measurement& measurement : recording.measurements) set.time_s.push_back(measurement.time_s);
    set.phases = recording.phases;
  };
  Progress progress;
  if (options.progress)
    progress = [&](std::size_t done, std::size_t) {
      options.progress(index * options.runs + done, scenarios.size() * options.runs);
    };
  monte_carlo(options.runs, options.threads, run_one, progress);
  return set;
}

Comparison summarise_sets(const TrackerSet& trackers, const std::vector<Scorer>& scorers,
                          std::span<const SetScores> sets, const ComparisonOptions& options) {
  Comparison comparison;
  comparison.seed = options.seed;
  comparison.runs = options.runs;
  comparison.bounds = options.bounds;
  std::vector<std::vector<const RunScore*>> by_tracker(scorers.size());
  std::vector<const BoundAtTimes*> bounds;
  std::vector<const AngleVariances*> angle_bounds;
  for (const SetScores& set : sets) {
    for (const std::vector<RunScore>& run : set.runs)
      for (std::size_t i = 0; i < scorers.size(); ++i) by_tracker[i].push_back(&run[i]);
    for (const BoundAtTimes& bound : set.bound) bounds.push_back(&bound);
    for (const AngleVariances& bound : set.angle_bound) angle_bounds.push_back(&bound);
  }
  const auto runs_of = [&](std::size_t i) { return TrackerRuns{options.scoring, scorers[i], by_tracker[i]}; };
  for (std::size_t i = 0; i < scorers.size(); ++i) {
    comparison.trackers.push_back(
        summarise(trackers.name(static_cast<int>(i)), scorers[i], by_tracker[i], options.scoring));
    comparison.trackers.back().metrics = metrics_of(runs_of(i));
  }

  const auto index_of = [&](const std::string& name) {
    for (int i = 0; i < trackers.size(); ++i)
      if (trackers.name(i) == name) return static_cast<std::size_t>(i);
    throw InputError("scoring", "there is no tracker \"" + name + "\" in this comparison");
  };
  const auto add_metrics = [](TrackerSummary& summary, const std::vector<Metric>& metrics) {
    summary.metrics.insert(summary.metrics.end(), metrics.begin(), metrics.end());
  };
  if (options.angle_bound) comparison.angle_bounds = summarise_angle_bounds(angle_bounds);
  if (options.cramer_rao) {
    comparison.cramer_rao = summarise_bound(bounds, options.scoring.times_s);
    for (TrackerSummary& summary : comparison.trackers)
      add_metrics(summary, range_efficiency(summary.metrics, comparison.cramer_rao->metrics));
  }
  if (!options.global_minimum.empty()) {
    const std::size_t best = index_of(options.global_minimum);
    for (std::size_t i = 0; i < scorers.size(); ++i)
      if (i != best) add_metrics(comparison.trackers[i], global_minimum_share(by_tracker[i], by_tracker[best]));
  }
  for (const auto& [a, b] : options.pairs) {
    const std::size_t ia = index_of(a), ib = index_of(b);
    Comparison::Pair& pair = comparison.pairs.emplace_back(
        Comparison::Pair{a, b, paired_difference(scorers[ia], by_tracker[ia], scorers[ib], by_tracker[ib])});
    for (PairedDifference& difference : paired_differences(runs_of(ia), runs_of(ib)))
      pair.differences.push_back(std::move(difference));
  }
  return comparison;
}

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

  std::vector<SetScores> sets;
  for (std::size_t i = 0; i < scenarios.size(); ++i) sets.push_back(run_set(trackers, scorers, scenarios, i, options));

  Comparison comparison = summarise_sets(trackers, scorers, sets, options);
  comparison.time_s = sets.front().time_s;
  comparison.phases = sets.front().phases;
  if (sets.size() < 2) return comparison;
  for (std::size_t i = 0; i < sets.size(); ++i) {
    Comparison of_set = summarise_sets(trackers, scorers, {&sets[i], 1}, options);
    of_set.time_s = sets[i].time_s;
    of_set.phases = sets[i].phases;
    comparison.sets.push_back({scenarios[i].name, std::move(of_set)});
  }
  return comparison;
}

double time_per_step_ns(Tracker& tracker, const Recording& recording) {
  using Clock = std::chrono::steady_clock;
  constexpr int kPasses = 5;
  std::vector<double> passes;
  for (int pass = 0; pass < kPasses; ++pass) {
    tracker.reset();
    const auto begin = Clock::now();
    for (const Measurement& measurement : recording.measurements) tracker.step(measurement);
    const std::chrono::duration<double, std::nano> elapsed = Clock::now() - begin;
    passes.push_back(elapsed.count() / static_cast<double>(std::max<std::size_t>(recording.measurements.size(), 1)));
  }
  std::sort(passes.begin(), passes.end());
  return passes[kPasses / 2];
}

}  // namespace truebearing
