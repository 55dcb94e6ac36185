// SPDX-License-Identifier: Apache-2.0
// Trackers and scenarios that do what a test tells them to.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "truebearing/simulation/scenario.hpp"
#include "truebearing/tracker/tracker.hpp"

namespace truebearing::testing {

/// Simulates by a function of the run's key.
class FakeScenario final : public Scenario {
 public:
  using Simulate = std::function<Recording(const RunKey&)>;
  FakeScenario(const StateSpace& truth, Simulate simulate) : truth_(&truth), simulate_(std::move(simulate)) {}
  /// The same recording in every run, of its truth's space.
  explicit FakeScenario(Recording recording)
      : truth_(recording.truth_space), measured_(Measured::of(recording.measured)) {
    simulate_ = [kept = std::move(recording)](const RunKey&) { return kept; };
  }

  Recording simulate(const RunKey& key) const override { return simulate_(key); }
  const StateSpace& truth_space() const override { return *truth_; }
  std::optional<Measured> measured() const override { return measured_; }

 private:
  const StateSpace* truth_;
  std::optional<Measured> measured_;
  Simulate simulate_;
};

/// Publishes what a function adds to `records`, empty at each step, and to `events`, empty at reset().
class FakeTracker final : public Tracker {
 public:
  struct Said {
    std::vector<StepRecord> records;
    std::vector<TrackEvent> events;
  };
  /// `step` counts from 0 since reset().
  using Say = std::function<void(const Measurement&, std::size_t step, Said& said)>;
  FakeTracker(const StateSpace& space, Say say, RecordBlocks blocks = {})
      : space_(&space), say_(std::move(say)), blocks_(blocks) {}

  std::span<const StepRecord> step(const Measurement& measurement) override {
    said_.records.clear();
    say_(measurement, step_++, said_);
    return said_.records;
  }
  void reset() override {
    step_ = 0;
    said_ = {};
  }
  std::unique_ptr<Tracker> fresh() const override { return std::make_unique<FakeTracker>(*space_, say_, blocks_); }
  const StateSpace& space() const override { return *space_; }
  RecordBlocks blocks() const override { return blocks_; }
  std::span<const TrackEvent> events() const override { return said_.events; }

 private:
  const StateSpace* space_;
  Say say_;
  RecordBlocks blocks_;
  std::size_t step_ = 0;
  Said said_;
};

/// A record of track 0 with this estimate, at the time of a measurement.
inline StepRecord fake_record(const StateSpace& space, const Measurement& measurement, const BoundedVector& x,
                              const BoundedMatrix& P) {
  StepRecord record;
  record.time_s = measurement.time_s;
  record.space = &space;
  record.x = x;
  record.P = P;
  return record;
}

/// On a line, with an innovation: publishes `record` as the test last left it, where `shown`, and what it `noticed`.
class ScriptedTracker final : public Tracker {
 public:
  explicit ScriptedTracker(RecordBlocks blocks = {true, true, true, false}) : blocks_(blocks) {
    record.space = &line_space();
    record.x = BoundedVector::Zero(2);
    record.P = BoundedMatrix::Identity(2, 2);
    record.innovation = Innovation{BoundedVector::Zero(1), BoundedVector::Zero(1), BoundedMatrix::Identity(1, 1), 0.0};
  }
  std::span<const StepRecord> step(const Measurement&) override { return {&record, shown ? 1u : 0u}; }
  void reset() override {}
  std::unique_ptr<Tracker> fresh() const override { return std::make_unique<ScriptedTracker>(*this); }
  const StateSpace& space() const override { return line_space(); }
  RecordBlocks blocks() const override { return blocks_; }
  std::span<const TrackEvent> events() const override { return noticed; }

  StepRecord record;
  std::vector<TrackEvent> noticed;
  bool shown = true;

 private:
  RecordBlocks blocks_;
};

}  // namespace truebearing::testing
