// SPDX-License-Identifier: Apache-2.0
// The Cramer-Rao bound over the runs of a comparison: the root of the mean over runs of their variances.
#pragma once

#include <vector>

#include "truebearing/evaluation/metric.hpp"
#include "truebearing/evaluation/target_motion_bound.hpp"

namespace truebearing {

struct BoundSummary {
  double position_m = 0.0;  ///< over runs and times
  double velocity_mps = 0.0;
  /// position_rmse, velocity_rmse, range_error_rmse, course_error_rmse, speed_error_rmse, and where it is measured
  /// frequency_rmse, at each time: what the metrics of those names cannot fall below. NaN where any run has no bound.
  std::vector<Metric> metrics;
};

/// Takes the variances [time] of run by run in the order of their numbers, and keeps their sums.
class BoundTally {
 public:
  void add(const std::vector<TargetMotionVariance>& run);
  void exchange(TallyStream& stream);
  BoundSummary summary(const std::vector<double>& times_s) const;

 private:
  void begin(std::size_t times);
  double mean(std::size_t time, double TargetMotionVariance::*variance) const;

  std::vector<TargetMotionVariance> sums_;  // [time]
  double runs_ = 0.0;
  bool has_frequency_ = false;  // is one bounded in any run at any time?
};

/// The same of all runs at once: [run][time].
BoundSummary summarise_bound(const std::vector<const std::vector<TargetMotionVariance>*>& runs,
                             const std::vector<double>& times_s);

/// `range_efficiency` at each time: range_error_rmse of a tracker over that of the bound. Empty where the tracker has
/// none.
std::vector<Metric> range_efficiency(const std::vector<Metric>& tracker, const std::vector<Metric>& bound);

}  // namespace truebearing
