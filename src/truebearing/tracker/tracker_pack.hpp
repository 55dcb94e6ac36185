// SPDX-License-Identifier: Apache-2.0
// TrackerPack: several trackers of one kind stepped together, each on a measurement of its own, as the targets of one
// radar or the runs of a Monte Carlo experiment are. What their filters do is done side by side; what they come to is what
// step() of each would, to the last bit.
#pragma once

#include <span>

#include "truebearing/measurement/measurement.hpp"
#include "truebearing/tracker/step_record.hpp"

namespace truebearing {

class Tracker;

class TrackerPack {
 public:
  struct Lane {
    Tracker* tracker;
    const Measurement* measurement;         ///< nullptr where there is none for this one now
    std::span<const StepRecord> records{};  ///< what step() would have returned
  };

  virtual ~TrackerPack() = default;

  /// Trackers made by fresh() from one. There are kPackLanes lanes: a tracker that finds none free, since more take turns,
  /// is stepped by itself. Between two calls each may be stepped, reset and asked by itself, on the thread of the pack.
  virtual void step(std::span<Lane> lanes) = 0;

 protected:
  TrackerPack() = default;
  TrackerPack(const TrackerPack&) = delete;
  TrackerPack& operator=(const TrackerPack&) = delete;
};

}  // namespace truebearing
