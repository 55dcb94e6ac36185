// SPDX-License-Identifier: Apache-2.0
// Which record of a tracker is about which target of a recording.
#pragma once

#include <algorithm>
#include <span>

#include "truebearing/recording/recording.hpp"
#include "truebearing/tracker/step_record.hpp"

namespace truebearing {

/// Of a recording with one target the first record, whatever its track is called; with several the record of the
/// target's track. nullptr where there is none.
inline const StepRecord* target_record(const Recording& recording, std::size_t target,
                                       std::span<const StepRecord> records) {
  if (recording.truth.size() == 1) return records.empty() ? nullptr : &records.front();
  const int track = recording.truth[target].track;
  const auto found =
      std::find_if(records.begin(), records.end(), [&](const StepRecord& r) { return r.track == track; });
  return found == records.end() ? nullptr : &*found;
}

}  // namespace truebearing
