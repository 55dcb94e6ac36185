// SPDX-License-Identifier: Apache-2.0
// StreamGuard: what every tracker asks of a measurement before it looks at the value. Decides, from the times and
// values alone, whether a measurement can be used, and counts the ones that cannot.
#pragma once

#include <cmath>

#include "truebearing/measurement/measurement.hpp"
#include "truebearing/tracker/tracker.hpp"

namespace truebearing {

/// True where the sensor's model can use the measurement, or a part of it.
template <typename Sensor>
bool has_value(const Sensor& sensor, const Measurement& measurement) {
  if constexpr (requires { sensor.has_value(measurement); })
    return sensor.has_value(measurement);
  else
    return !measurement.is_missing() && measurement.z.size() == Sensor::Model::kMeasurements;
}

class StreamGuard {
 public:
  enum class Verdict {
    usable,
    missing,      ///< no finite value: predict to its time only
    repeated,     ///< the same time and values as the measurement before: use it once
    out_of_order  ///< earlier than the measurement before, or its time is not finite: leave the state alone
  };

  /// `usable` of a sensor that can do with a part of z.
  Verdict examine(const Measurement& measurement) { return examine(measurement, !measurement.is_missing()); }
  Verdict examine(const Measurement& measurement, bool usable) {
    if (!std::isfinite(measurement.time_s) || (started_ && measurement.time_s < time_s_)) {
      ++counts.out_of_order;
      return Verdict::out_of_order;
    }
    if (!usable) {
      ++counts.missing;
      advance(measurement.time_s);
      return Verdict::missing;
    }
    if (started_ && measurement.time_s == time_s_ && measurement.source == source_ && is_last(measurement.z)) {
      ++counts.repeated;
      return Verdict::repeated;
    }
    advance(measurement.time_s);
    last_z_ = measurement.z;
    source_ = measurement.source;
    return Verdict::usable;
  }

  TrackerCounts counts;

 private:
  bool is_last(const BoundedVector& z) const {
    if (z.size() != last_z_.size()) return false;
    for (Eigen::Index i = 0; i < z.size(); ++i)
      if (z[i] != last_z_[i] && !(std::isnan(z[i]) && std::isnan(last_z_[i]))) return false;
    return true;
  }

  void advance(double time_s) {
    time_s_ = time_s;
    started_ = true;
  }

  bool started_ = false;
  double time_s_ = 0.0;
  BoundedVector last_z_;
  int source_ = 0;
};

}  // namespace truebearing
