// SPDX-License-Identifier: Apache-2.0
// A tracker that looks back: told of all measurements of a run (foresee), each step says what they all, or those of a
// lag, make of the state there; and how much more that is than its filter knew. Not told of them, it is the filter.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "truebearing/core/bounded.hpp"
#include "truebearing/core/constants.hpp"
#include "truebearing/tracker/tracker.hpp"

namespace truebearing {

/// What a smoother knows of one of its steps beside the record.
struct SmoothingAccount {
  bool looked_back = false;       ///< else the record is the filter's own
  BoundedVector filter_variance;  ///< (n), the diagonal of P as the filter published it
  double nis = kNaN;              ///< of the filter's innovation, where it had one
  int measured = 0;               ///< its components
};

/// What the record of a step will be.
struct SmoothingStep {
  int track = 0, source = 0;
  double time_s = 0.0;
  StepStatus status = StepStatus::ok;
  BoundedVector x;
  BoundedMatrix P;
  ModeVector mu;  // empty of a single filter
  std::optional<SensorState> sensor;
  SmoothingAccount account;
  std::size_t knot = 0;  // the last at or before it
  bool is_at_knot = false;
  bool is_as_before = false;  // a measurement that was not looked at: the step before stands
  bool can_look_back = false;
};

class Smoother : public Tracker {
 public:
  std::span<const StepRecord> step(const Measurement& measurement) final {
    account_ = nullptr;
    if (!foreseen_) return filter().step(measurement);
    return replay();
  }
  TrackerCounts counts() const final { return foreseen_ ? counts_ : filter().counts(); }
  /// Of the last step, where it has a record.
  const SmoothingAccount* account() const { return account_; }

 protected:
  using Step = SmoothingStep;

  explicit Smoother(const StateSpace& space) { record_.space = &space; }

  /// The filter whose records these are before anything is looked back at.
  virtual Tracker& filter() = 0;
  virtual const Tracker& filter() const = 0;

  void forget() {
    foreseen_ = false;
    steps_.clear();
    counted_.clear();
    next_ = 0;
    counts_ = {};
    account_ = nullptr;
  }
  /// The step of the measurement that the filter took last: as its record has it, or none.
  Step* add_step(std::span<const StepRecord> records) {
    counted_.push_back(filter().counts());
    std::optional<Step>& step = steps_.emplace_back();
    if (records.empty()) return nullptr;
    const StepRecord& record = records.front();
    step.emplace();
    step->track = record.track;
    step->source = record.source;
    step->time_s = record.time_s;
    step->status = record.status;
    step->x = record.x;
    step->P = record.P;
    if (record.mode_probabilities) step->mu = *record.mode_probabilities;
    step->sensor = record.sensor;
    step->account.filter_variance = record.P.diagonal();
    return &*step;
  }
  /// After all of them were smoothed: from now on step() says what they came to.
  void begin_replay() {
    const Step* before = nullptr;
    for (std::optional<Step>& step : steps_) {
      if (!step) continue;
      if (step->is_as_before && before) {
        step->x = before->x;
        step->P = before->P;
        step->mu = before->mu;
        step->account = before->account;
      }
      before = &*step;
    }
    foreseen_ = true;
  }

  std::vector<std::optional<Step>> steps_;  // one per measurement; none before a track exists

 private:
  std::span<const StepRecord> replay() {
    if (next_ >= steps_.size()) return {};
    counts_ = counted_[next_];
    const std::optional<Step>& step = steps_[next_++];
    if (!step) return {};
    account_ = &step->account;
    record_.track = step->track;
    record_.source = step->source;
    record_.time_s = step->time_s;
    record_.status = step->status;
    record_.x = step->x;
    record_.P = step->P;
    record_.sensor = step->sensor;
    if (step->mu.size() > 0) record_.mode_probabilities = step->mu;
    return {&record_, 1};
  }

  bool foreseen_ = false;
  std::vector<TrackerCounts> counted_;  // after each measurement
  std::size_t next_ = 0;                // measurement
  TrackerCounts counts_;
  const SmoothingAccount* account_ = nullptr;
  StepRecord record_;
};

}  // namespace truebearing
