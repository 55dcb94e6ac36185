// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/comparison_runs.hpp"

#include <algorithm>
#include <map>
#include <mutex>
#include <utility>

#include "truebearing/evaluation/time_steps.hpp"

namespace truebearing {
namespace {

constexpr std::size_t kMostRunsEvenlyShared = 16;
constexpr std::size_t kFewBlocks = 256;    // enough to share among the cores of a machine
constexpr std::size_t kMostBlocks = 4096;  // of a set

std::size_t medians_of(const ComparisonRuns& runs) {  // at a time: of all sets, and of one
  std::size_t medians = 0;
  for (const Scorer& scorer : runs.scorers())
    medians += (runs.scenarios().size() > 1 ? 2 : 1) * scorer.quantities().size();
  return std::max<std::size_t>(medians, 1);
}

ComparisonTally tally_of(const ComparisonRuns& runs, bool details) {
  return {runs.trackers(), runs.scorers(), runs.options(), kMostValuesApart / medians_of(runs), details};
}

ComparisonOptions of_different_runs(ComparisonOptions options, const std::vector<NamedScenario>& scenarios) {
  std::size_t most = 0;
  for (const NamedScenario& named : scenarios)
    most = std::max(most, named.scenario->different_runs(options.role).value_or(options.runs));
  options.runs = std::min(most, options.runs);
  return options;
}

}  // namespace

std::size_t runs_of_block(std::size_t runs) {
  std::size_t size = 1;
  while (size < kMostRunsEvenlyShared && runs > kFewBlocks * size) size *= 2;
  while (runs > 0 && (runs - 1) / size >= kMostBlocks) size *= 2;
  return size;
}

ComparisonRuns::ComparisonRuns(const TrackerSet& trackers, const std::vector<NamedScenario>& scenarios,
                               const ComparisonOptions& options)
    : trackers_(trackers),
      scenarios_(scenarios),
      options_(of_different_runs(options, scenarios)),
      runs_of_block_(runs_of_block(options_.runs)),
      blocks_of_set_((options_.runs + runs_of_block_ - 1) / runs_of_block_),
      copies_(worker_count(options.threads)) {
  for (int i = 0; i < trackers.size(); ++i)
    scorers_.emplace_back(scenarios.front().scenario->truth_space(), trackers.space(i));
}

std::size_t ComparisonRuns::runs_in(std::size_t block) const {
  return std::min(runs_of_block_, options_.runs - block % blocks_of_set_ * runs_of_block_);
}

std::string ComparisonRuns::run(std::size_t block, std::size_t worker) {
  std::unique_ptr<TrackerSetPack>& copies = copies_[worker];
  if (!copies) copies = std::make_unique<TrackerSetPack>(trackers_, trackers_.best_together(runs_of_block_));
  const bool compact = runs_of_block_ > kMostRunsEvenlyShared;
  ComparisonTally tally(trackers_, scorers_, options_, compact ? kMostRunsApart : kMostValuesApart, options_.details);
  const std::size_t first = block % blocks_of_set_ * runs_of_block_, count = runs_in(block);
  for (std::size_t done = 0; done < count; done += copies->size())
    for (const RunOutcome& outcome :
         outcomes(set_of(block), first + done, std::min(copies->size(), count - done), *copies))
      tally.add(outcome);
  return tally.bytes(compact);
}

std::vector<RunOutcome> ComparisonRuns::outcomes(std::size_t set, std::size_t first, std::size_t count,
                                                 TrackerSetPack& copies) const {
  std::vector<RunOutcome> outcomes(count);
  std::vector<Recording> recordings;
  for (std::size_t i = 0; i < count; ++i) {
    recordings.push_back(scenarios_[set].scenario->simulate({options_.seed, options_.role, first + i}));
    if (options_.details) outcomes[i].corrections = correction_tallies(copies.set(i));
  }
  std::vector<const Recording*> all;
  for (const Recording& recording : recordings) all.push_back(&recording);
  std::function<void(std::size_t, std::size_t)> tell_details;
  if (options_.details)
    tell_details = [&](std::size_t i, std::size_t step) {
      const TrackerSet& copy = copies.set(i);
      auto& tallies = outcomes[i].corrections;
      for (std::size_t entry = 0; entry < tallies.size(); ++entry)
        if (tallies[entry])
          tallies[entry]->take(step, copy.records(static_cast<int>(entry)),
                               copy.correction(static_cast<int>(entry))->accounts());
    };
  std::vector<std::vector<RunScore>> scores = score_recordings(copies, scorers_, all, options_.scoring, tell_details);
  for (std::size_t i = 0; i < count; ++i) {
    RunOutcome& outcome = outcomes[i];
    const Recording& recording = recordings[i];
    outcome.scores = std::move(scores[i]);
    if (options_.cramer_rao)
      outcome.bound = options_.cramer_rao->variances(recording, steps_at(recording, options_.scoring.times_s));
    if (options_.angle_bound)
      outcome.angle_bound = options_.angle_bound->variances(recording, options_.scoring.from_step);
  }
  return outcomes;
}

void run_blocks(ComparisonRuns& runs, const BlockRange& blocks, const Progress& progress,
                const std::function<void(std::size_t block, std::string_view bytes)>& take) {
  std::size_t total = 0, done = 0, next = 0;
  for (std::size_t i = 0; i < blocks.size(); ++i) total += runs.runs_in(blocks.first + i * blocks.stride);
  std::map<std::size_t, std::string> waiting;  // for one before them
  std::mutex mutex;
  monte_carlo(blocks.size(), runs.options().threads, [&](std::size_t i, std::size_t worker) {
    const std::size_t block = blocks.first + i * blocks.stride;
    std::string bytes = runs.run(block, worker);
    const std::lock_guard lock(mutex);
    waiting.emplace(i, std::move(bytes));
    for (auto it = waiting.begin(); it != waiting.end() && it->first == next; it = waiting.erase(it), ++next)
      take(blocks.first + it->first * blocks.stride, it->second);
    done += runs.runs_in(block);
    if (progress) progress(done, total);
  });
}

ComparisonFigures::ComparisonFigures(const ComparisonRuns& runs)
    : runs_(runs), all_(tally_of(runs, runs.options().details)) {
  if (runs.scenarios().size() > 1)
    for (std::size_t set = 0; set < runs.scenarios().size(); ++set) sets_.push_back(tally_of(runs, false));
}

void ComparisonFigures::add(std::size_t block, std::string_view bytes) {
  all_.add(bytes);
  if (!sets_.empty()) sets_[runs_.set_of(block)].add(bytes);
}

Comparison ComparisonFigures::comparison() const {
  const ComparisonOptions& options = runs_.options();
  const auto finish = [&](Comparison comparison, const NamedScenario& scenario, const std::string& set) {
    const Recording first = scenario.scenario->simulate({options.seed, options.role, 0});
    for (const Measurement& measurement : first.measurements) comparison.time_s.push_back(measurement.time_s);
    comparison.phases = first.phases;
    comparison.published = published_of(options.published, set);
    return comparison;
  };
  Comparison comparison = finish(all_.comparison(), runs_.scenarios().front(), {});
  for (std::size_t set = 0; set < sets_.size(); ++set) {
    const NamedScenario& scenario = runs_.scenarios()[set];
    comparison.sets.push_back({scenario.name, finish(sets_[set].comparison(), scenario, scenario.name)});
  }
  return comparison;
}

}  // namespace truebearing
