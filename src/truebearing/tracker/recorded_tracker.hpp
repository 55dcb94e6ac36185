// SPDX-License-Identifier: Apache-2.0
// A tracker that ran elsewhere, replayed from its step log, so that it can be corrected and compared without being
// touched. It replays one log, matched by time; or, on the measurements of step logs, what each of them carries.
#pragma once

#include <memory>
#include <vector>

#include "truebearing/tracker/step_log.hpp"
#include "truebearing/tracker/tracker.hpp"

namespace truebearing {

class RecordedTracker final : public Tracker {
 public:
  explicit RecordedTracker(StepLog log);
  /// Replays Measurement::recorded, for states of this space; `innovation`: do the records carry one?
  RecordedTracker(const StateSpace& space, bool innovation) : space_(&space), innovation_(innovation) {}

  /// Does it replay what measurements carry?
  bool replays_measurements() const { return !log_; }

  /// The log's records of the measurement's time, to a microsecond; none where it has none of that time. Or the
  /// measurement's own record; none where it carries none of this space.
  std::span<const StepRecord> step(const Measurement& measurement) override;
  void reset() override { next_ = 0; }
  std::unique_ptr<Tracker> fresh() const override;
  const StateSpace& space() const override { return *space_; }
  /// Beside a log of its own any measurement will do: it asks for the time alone.
  std::optional<Measured> measures() const override {
    return log_ ? std::nullopt : std::optional(Measured::step_log(*space_));
  }
  /// In the plane z_1 and z_2 of a step log are the measured position.
  RecordBlocks blocks() const override {
    return {.innovation = innovation_, .measures_position = innovation_ && *space_ == plane_space()};
  }

 private:
  const StateSpace* space_;
  bool innovation_;
  std::shared_ptr<const StepLog> log_;
  std::size_t next_ = 0;
};

}  // namespace truebearing
