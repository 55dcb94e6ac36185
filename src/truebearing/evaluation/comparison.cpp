#include "truebearing/evaluation/comparison.hpp"

#include <algorithm>
#include <chrono>
#include <optional>

#include "truebearing/core/error.hpp"

namespace truebearing {

namespace {

struct SetScores {
  std::vector<std::vector<RunScore>> runs;  // [run][tracker]
  std::vector<double> time_s;               // of the first run
  std::vector<std::string> phases;
};

SetScores run_set(const TrackerSet& trackers, const std::vector<Scorer>& scorers,
                  const std::vector<NamedScenario>& scenarios, std::size_t index, const ComparisonOptions& options) {
  const Scenario& scenario = *scenarios[index].scenario;
  SetScores set;
  set.runs.resize(options.runs);
  std::vector<std::optional<TrackerSet>> clones(worker_count(options.threads));
  const auto run_one = [&](std::size_t run, std::size_t worker) {
    if (!clones[worker]) clones[worker].emplace(trackers.clone());
    const Recording recording = scenario.simulate({options.seed, options.role, run});
    set.runs[run] = score_recording(*clones[worker], scorers, recording, options.scoring);
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

Comparison summarise_runs(const TrackerSet& trackers, const std::vector<Scorer>& scorers,
                          const std::vector<const std::vector<RunScore>*>& runs, const ComparisonOptions& options) {
  Comparison comparison;
  comparison.seed = options.seed;
  comparison.runs = options.runs;
  comparison.bounds = options.bounds;
  std::vector<std::vector<const RunScore*>> by_tracker(scorers.size());
  for (const std::vector<RunScore>* run : runs)
    for (std::size_t i = 0; i < scorers.size(); ++i) by_tracker[i].push_back(&(*run)[i]);
  for (std::size_t i = 0; i < scorers.size(); ++i)
    comparison.trackers.push_back(
        summarise(trackers.name(static_cast<int>(i)), scorers[i], by_tracker[i], options.scoring));

  const auto index_of = [&](const std::string& name) {
    for (int i = 0; i < trackers.size(); ++i)
      if (trackers.name(i) == name) return static_cast<std::size_t>(i);
    throw InputError("pairs", "there is no tracker \"" + name + "\" in this comparison");
  };
  for (const auto& [a, b] : options.pairs) {
    const std::size_t ia = index_of(a), ib = index_of(b);
    comparison.pairs.push_back({a, b, paired_difference(scorers[ia], by_tracker[ia], scorers[ib], by_tracker[ib])});
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

  std::vector<const std::vector<RunScore>*> all;
  for (const SetScores& set : sets)
    for (const std::vector<RunScore>& run : set.runs) all.push_back(&run);
  Comparison comparison = summarise_runs(trackers, scorers, all, options);
  comparison.time_s = sets.front().time_s;
  comparison.phases = sets.front().phases;
  if (sets.size() < 2) return comparison;
  for (std::size_t i = 0; i < sets.size(); ++i) {
    std::vector<const std::vector<RunScore>*> runs;
    for (const std::vector<RunScore>& run : sets[i].runs) runs.push_back(&run);
    comparison.sets.emplace_back(scenarios[i].name, summarise_runs(trackers, scorers, runs, options));
    comparison.sets.back().second.time_s = sets[i].time_s;
    comparison.sets.back().second.phases = sets[i].phases;
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
