// SPDX-License-Identifier: Apache-2.0
// The line array that a recording of snapshots is of: a snapshot log has one, the same in every interval.
#pragma once

#include "truebearing/array/line_array.hpp"
#include "truebearing/recording/recording.hpp"

namespace truebearing {

/// Of a recording that read_snapshot_log() gave.
inline LineArray array_of(const Recording& recording) {
  const SnapshotBlock& block = recording.measurements.at(0).snapshots.value();
  return {block.sensors, block.spacing_wavelengths};
}

}  // namespace truebearing
