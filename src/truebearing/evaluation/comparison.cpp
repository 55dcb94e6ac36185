// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/comparison.hpp"

#include <algorithm>
#include <chrono>
#include <vector>

#include "truebearing/evaluation/comparison_runs.hpp"

namespace truebearing {

const TrackerSummary* Comparison::tracker(const std::string& name) const {
  for (const TrackerSummary& summary : trackers)
    if (summary.name == name) return &summary;
  return nullptr;
}

Comparison compare(const TrackerSet& trackers, const std::vector<NamedScenario>& scenarios,
                   const ComparisonOptions& options) {
  ComparisonRuns runs(trackers, scenarios, options);
  ComparisonFigures figures(runs);
  run_blocks(runs, BlockRange{0, runs.blocks()}, options.progress,
             [&](std::size_t block, std::string_view bytes) { figures.add(block, bytes); });
  return figures.comparison();
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
