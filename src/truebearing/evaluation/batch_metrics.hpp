// SPDX-License-Identifier: Apache-2.0
// Figures of batch estimators (tma/) at the times of a scoring rule: how they came to their estimates. Their names and
// definitions are those of docs/metrics.md.
#pragma once

#include <memory>
#include <optional>

#include "truebearing/evaluation/metric_family.hpp"

namespace truebearing {

struct BatchFigures : StepFigures {
  std::vector<std::optional<BatchOutcome>> at_times;  ///< [time] of the rule, of one that solved at its step
};

/// non_finite_starts and iterations, of a tracker that solved at any time of any run.
std::shared_ptr<const MetricFamily> batch_metrics();

/// Share of runs and times, of those at which a reference solved, at which another batch estimator came to a cost as
/// low, but for rounding. Runs are added in pairs, and gone afterwards.
class GlobalMinimumTally {
 public:
  void add(const RunScore& run, const RunScore& reference);
  void exchange(TallyStream& stream);
  /// Nothing where either never solved.
  std::vector<Metric> metrics() const;

 private:
  double solved_ = 0.0;
  double compared_ = 0.0;
  double found_ = 0.0;
};

/// The same of all runs at once.
std::vector<Metric> global_minimum_share(const std::vector<const RunScore*>& scores,
                                         const std::vector<const RunScore*>& reference);

}  // namespace truebearing
