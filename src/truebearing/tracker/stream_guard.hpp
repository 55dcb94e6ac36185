// StreamGuard: what every tracker asks of a measurement before it looks at the value. Decides, from the times and
// values alone, whether a measurement can be used, and counts the ones that cannot.
#pragma once

#include <cmath>

#include "truebearing/measurement/measurement.hpp"
#include "truebearing/tracker/tracker.hpp"

namespace truebearing {

class StreamGuard {
 public:
  enum class Verdict {
    usable,
    missing,      ///< no finite value: predict to its time only
    repeated,     ///< the same time and values as the measurement before: use it once
    out_of_order  ///< earlier than the measurement before, or its time is not finite: leave the state alone
  };

  Verdict examine(const Measurement& measurement) {
    if (!std::isfinite(measurement.time_s) || (started_ && measurement.time_s < time_s_)) {
      ++counts.out_of_order;
      return Verdict::out_of_order;
    }
    if (measurement.is_missing()) {
      ++counts.missing;
      advance(measurement.time_s);
      return Verdict::missing;
    }
    if (started_ && measurement.time_s == time_s_ && last_z_.size() == measurement.z.size() &&
        last_z_ == measurement.z) {
      ++counts.repeated;
      return Verdict::repeated;
    }
    advance(measurement.time_s);
    last_z_ = measurement.z;
    return Verdict::usable;
  }

  TrackerCounts counts;

 private:
  void advance(double time_s) {
    time_s_ = time_s;
    started_ = true;
  }

  bool started_ = false;
  double time_s_ = 0.0;
  BoundedVector last_z_;
};

}  // namespace truebearing
