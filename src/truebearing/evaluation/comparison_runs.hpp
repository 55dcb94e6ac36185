// SPDX-License-Identifier: Apache-2.0
// The runs of a comparison cut into blocks, and the figures of blocks that are added in their order. What computes the
// blocks may be threads, processes or machines of one kind (docs/scale.md): the figures are the same to the last bit,
// as how runs are cut depends on their number alone.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "truebearing/evaluation/comparison_tally.hpp"

namespace truebearing {

/// Of a set. What would break beyond it stands in docs/scale.md.
inline constexpr std::size_t kMostRuns = 1000000000;

/// Runs of a block of a set that has so many: 1 for few, 16 for thousands, and so many that a set has no more than 4096
/// blocks. Those of more than 16 come compact.
std::size_t runs_of_block(std::size_t runs);

class ComparisonRuns {
 public:
  /// Trackers and scenarios must outlive it. Of scenarios of which no more runs differ than so many (different_runs()), no
  /// more are made: the same run again would count as one that is independent of the first.
  ComparisonRuns(const TrackerSet& trackers, const std::vector<NamedScenario>& scenarios,
                 const ComparisonOptions& options);

  /// Of all sets, one set after another.
  std::size_t blocks() const { return scenarios_.size() * blocks_of_set_; }
  std::size_t set_of(std::size_t block) const { return block / blocks_of_set_; }
  std::size_t runs_in(std::size_t block) const;
  /// Runs a block and gives its tally. Of two calls with the same worker number one ends before the other begins.
  std::string run(std::size_t block, std::size_t worker);

  const TrackerSet& trackers() const { return trackers_; }
  const std::vector<NamedScenario>& scenarios() const { return scenarios_; }
  const ComparisonOptions& options() const { return options_; }
  const std::vector<Scorer>& scorers() const { return scorers_; }

 private:
  std::vector<RunOutcome> outcomes(std::size_t set, std::size_t first, std::size_t count, TrackerSetPack& copies) const;

  const TrackerSet& trackers_;
  const std::vector<NamedScenario>& scenarios_;
  const ComparisonOptions options_;
  std::vector<Scorer> scorers_;
  std::size_t runs_of_block_;
  std::size_t blocks_of_set_;
  std::vector<std::unique_ptr<TrackerSetPack>> copies_;  // [worker]
};

/// Blocks first, first + stride and so on, before last.
struct BlockRange {
  std::size_t first, last;
  std::size_t stride = 1;

  std::size_t size() const { return first < last ? (last - first + stride - 1) / stride : 0; }
};

/// Runs those blocks on the threads of the options, and gives the tally of each to `take` in
/// their order, from one thread at a time. progress: of the runs of these blocks.
void run_blocks(ComparisonRuns& runs, const BlockRange& blocks, const Progress& progress,
                const std::function<void(std::size_t block, std::string_view bytes)>& take);

/// The figures of all blocks, which are added in their order.
class ComparisonFigures {
 public:
  /// The runs must outlive it.
  explicit ComparisonFigures(const ComparisonRuns& runs);

  /// Throws InputError where the bytes are no tally of such runs.
  void add(std::size_t block, std::string_view bytes);
  Comparison comparison() const;

 private:
  const ComparisonRuns& runs_;
  ComparisonTally all_;
  std::vector<ComparisonTally> sets_;  // where there are several
};

}  // namespace truebearing
