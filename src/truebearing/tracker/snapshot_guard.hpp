// SPDX-License-Identifier: Apache-2.0
// StreamGuard for snapshots: two blocks of one time are the same where their sums are.
#pragma once

#include "truebearing/array/interval.hpp"
#include "truebearing/tracker/stream_guard.hpp"

namespace truebearing {

/// What the guard says of the measurement; `interval` has taken its snapshots, where it has any.
inline StreamGuard::Verdict examine_snapshots(StreamGuard& guard, const Measurement& measurement, Interval& interval) {
  Measurement sums;
  sums.time_s = measurement.time_s;
  bool usable = false;
  if (measurement.snapshots) {
    interval.take(*measurement.snapshots);
    usable = interval.is_usable();
    sums.z = interval.sums();
  }
  return guard.examine(sums, usable);
}

}  // namespace truebearing
