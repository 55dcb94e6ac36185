// SPDX-License-Identifier: Apache-2.0
// A step log as recordings: what a tracker elsewhere measured and made of it, so that a correction can be trained on
// its logs and applied to new ones.
#pragma once

#include <string>
#include <vector>

#include "truebearing/recording/recording.hpp"
#include "truebearing/tracker/step_log.hpp"

namespace truebearing {

/// One track of a log. Its records are numbered 0 in the recording, as trackers of one target are.
struct RecordedTrack {
  int track = 0;  ///< its number in the log
  Recording recording;
};

/// One recording per track of the log, in the order of their first rows. Every measurement carries its record in
/// Measurement::recorded; z is that of the log, missing where it has none. The truth, in the log's own space, is NaN
/// where the log has no column for a component, but velocities are completed from positions as in measurement logs.
/// Throws InputError, in the name of the log, where a truth column is no component of the state.
std::vector<RecordedTrack> recordings_of(const StepLog& log, const std::string& name);

}  // namespace truebearing
