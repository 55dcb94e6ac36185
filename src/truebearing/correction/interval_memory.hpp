// SPDX-License-Identifier: Apache-2.0
// IntervalMemory: how often a tracker has lately used a measurement, and how long ago. A network that was taught at one
// period knows nothing of another, nor of outages; this is what its gate sees of them (box_gate.hpp).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "truebearing/core/constants.hpp"
#include "truebearing/tracker/step_record.hpp"

namespace truebearing {

struct Intervals {
  double shortest_s = kNaN;  ///< of the last few between used measurements; NaN before there is one
  double longest_s = kNaN;
  double coast_s = 0.0;  ///< since the last used measurement; 0 at a step that uses one
};

class IntervalMemory {
 public:
  void reset() { *this = {}; }

  /// Every step of a track once. A step that uses no measurement leaves no trace.
  void take(const StepRecord& record) {
    const double since_s = record.time_s - used_s_;  // NaN before the first
    const bool uses = record.status == StepStatus::ok;
    intervals_.coast_s = uses || std::isnan(since_s) ? 0.0 : since_s;
    if (!uses) return;
    used_s_ = record.time_s;
    if (std::isnan(since_s)) return;
    last_s_ = {since_s, last_s_[0], last_s_[1]};
    count_ = std::min(count_ + 1, last_s_.size());
    intervals_.shortest_s = intervals_.longest_s = since_s;
    for (std::size_t i = 1; i < count_; ++i) {
      intervals_.shortest_s = std::min(intervals_.shortest_s, last_s_[i]);
      intervals_.longest_s = std::max(intervals_.longest_s, last_s_[i]);
    }
  }

  const Intervals& intervals() const { return intervals_; }

 private:
  double used_s_ = kNaN;
  std::array<double, 3> last_s_{};  // the newest first
  std::size_t count_ = 0;
  Intervals intervals_;
};

}  // namespace truebearing
