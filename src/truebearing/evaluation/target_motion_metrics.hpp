// SPDX-License-Identifier: Apache-2.0
// Errors in a target's range, course and speed, as its own ship sees it (target_motion.hpp), at the times of a scoring
// rule. Their names and definitions are those of docs/metrics.md. Key of [scoring]: target_motion = true, beside times_s.
#pragma once

#include <memory>

#include "truebearing/evaluation/metric_family.hpp"
#include "truebearing/evaluation/target_motion.hpp"

namespace truebearing {

struct TargetMotionFigures : StepFigures {
  std::vector<TargetMotionError> at_times;  ///< [time] of the rule; NaN where the tracker has no estimate
};

/// range_error_mean, _std, _rmse and _median, course_error_rmse and speed_error_rmse at each time; time_to_20_percent.
/// Refuses recordings without a sensor's state or a truth in the plane.
std::shared_ptr<const MetricFamily> target_motion_metrics();

}  // namespace truebearing
