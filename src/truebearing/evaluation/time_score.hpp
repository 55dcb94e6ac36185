// What is kept of one tracker's run at a given time. The periods of a family's runs differ: a run's step at a time is
// its last one until then.
#pragma once

#include <optional>
#include <vector>

#include "truebearing/evaluation/target_motion.hpp"
#include "truebearing/recording/recording.hpp"
#include "truebearing/tracker/step_record.hpp"

namespace truebearing {

struct TimeScore {
  int step = -1;                  ///< of the run; -1 where it does not reach the time or its truth is unknown then
  TargetMotionError motion = {};  ///< NaN where it is not asked for, or the tracker has no estimate
  std::optional<BatchOutcome> batch = std::nullopt;  ///< of a batch estimator that solved at this step

  void take(const BoundedVector& truth, const StepRecord& record, const std::optional<SensorState>& own_ship,
            bool target_motion);
};

/// The step of the recording, which has one target, for each time; -1 as above. A run reaches a time that comes within
/// its longest period after the last step.
std::vector<int> steps_at(const Recording& recording, const std::vector<double>& times_s);

}  // namespace truebearing
