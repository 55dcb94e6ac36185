#include "truebearing/evaluation/comparison.hpp"

#include <algorithm>
#include <chrono>
#include <optional>

#include "truebearing/core/error.hpp"

namespace truebearing {

const TrackerSummary* Comparison::tracker(const std::string& name) const {
  for (const TrackerSummary& summary : trackers)
    if (summary.name == name) return &summary;
  return nullptr;
}

Comparison compare(const TrackerSet& trackers, const Scenario& scenario, const ComparisonOptions& options) {
  std::vector<Scorer> scorers;
  for (int i = 0; i < trackers.size(); ++i) scorers.emplace_back(scenario.truth_space(), trackers.space(i));

  std::vector<std::vector<RunScore>> scores(options.runs);  // [run][tracker]
  std::vector<std::optional<TrackerSet>> sets(worker_count(options.threads));
  std::vector<double> time_s;
  const auto run_one = [&](std::size_t run, std::size_t worker) {
    std::optional<TrackerSet>& set = sets[worker];
    if (!set) set.emplace(trackers.clone());
    const Recording recording = scenario.simulate({options.seed, options.role, run});
    scores[run] = score_recording(*set, scorers, recording, options.scoring);
    if (run == 0)
      for (const Measurement& measurement : recording.measurements) time_s.push_back(measurement.time_s);
  };
  monte_carlo(options.runs, options.threads, run_one, options.progress);

  Comparison comparison;
  comparison.seed = options.seed;
  comparison.runs = options.runs;
  comparison.time_s = std::move(time_s);
  comparison.bounds = options.bounds;
  std::vector<std::vector<const RunScore*>> by_tracker(scorers.size());
  for (const std::vector<RunScore>& run : scores)
    for (std::size_t i = 0; i < scorers.size(); ++i) by_tracker[i].push_back(&run[i]);
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
