// SPDX-License-Identifier: Apache-2.0
// ComparisonTally: all that a comparison keeps of its runs, added in the order of their numbers; and of several, block
// by block.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "truebearing/evaluation/batch_metrics.hpp"
#include "truebearing/evaluation/comparison.hpp"

namespace truebearing {

/// What one run gives.
struct RunOutcome {
  std::vector<RunScore> scores;             ///< [tracker]
  std::vector<TargetMotionVariance> bound;  ///< [time], where the options ask for them
  AngleVariances angle_bound;
  std::vector<std::optional<CorrectionTally>> corrections;  ///< [tracker], where the options ask for details
};

/// An empty one for each tracker that is a correction.
std::vector<std::optional<CorrectionTally>> correction_tallies(const TrackerSet& trackers);

class ComparisonTally {
 public:
  /// kept_apart: as for SummaryTally. All but the trackers must outlive it.
  ComparisonTally(const TrackerSet& trackers, const std::vector<Scorer>& scorers, const ComparisonOptions& options,
                  std::size_t kept_apart, bool details);

  void add(const RunOutcome& run);
  /// The runs of a block as bytes, of which blocks are made that are as good as the runs one by one; compact: of so many
  /// runs that they are better taken together.
  std::string bytes(bool compact);
  /// Adds the block that comes next. A tally without details adds one with them too. Throws InputError.
  void add(std::string_view bytes);
  Comparison comparison() const;

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
  void exchange(TallyStream& stream);

  const ComparisonOptions& options_;
  std::vector<OfTracker> trackers_;
  std::vector<DetailsTally> details_;                        // [tracker], or empty
  std::vector<std::optional<CorrectionTally>> corrections_;  // likewise
  std::optional<std::size_t> global_minimum_;
  std::vector<Pair> pairs_;
  BoundTally bound_;
  AngleBoundTally angle_bound_;
};

}  // namespace truebearing
