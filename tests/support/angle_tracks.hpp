// Several targets told apart by their angles, and a tracker that says of them what it is told to: for the tests of
// everything that stands behind a tracker of several targets.
#pragma once

#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "truebearing/core/angle.hpp"
#include "truebearing/simulation/scenario.hpp"
#include "truebearing/tracker/tracker.hpp"

namespace truebearing::testing {

/// Angles in degrees by track, at each step; NaN where there is none.
using AnglesOfTracks = std::map<int, std::vector<double>>;

/// Those angles as truth, at 1, 2, ... s; every rate is 0.
inline Recording angle_recording(const AnglesOfTracks& angles_deg) {
  Recording recording;
  recording.measured = {"snapshots"};
  recording.truth_space = &angle_space();
  for (std::size_t step = 0; step < angles_deg.begin()->second.size(); ++step) {
    recording.measurements.emplace_back();
    recording.measurements.back().time_s = static_cast<double>(step + 1);
  }
  for (const auto& [track, angles] : angles_deg) {
    recording.truth.push_back({.track = track, .x = {}, .phase = {}});
    for (const double angle : angles) {
      const bool is_there = angle == angle;
      recording.truth.back().x.emplace_back(Eigen::Vector2d(radians(angle), is_there ? 0.0 : angle));
    }
  }
  return recording;
}

/// The same recording in every run.
class AngleScenario final : public Scenario {
 public:
  explicit AngleScenario(Recording recording) : recording_(std::move(recording)) {}
  Recording simulate(const RunKey&) const override { return recording_; }
  const StateSpace& truth_space() const override { return angle_space(); }

 private:
  Recording recording_;
};

/// Publishes those angles, each with a rate of 0 and a standard deviation of 1 degree; no record where one is NaN.
class ToldTracker final : public Tracker {
 public:
  explicit ToldTracker(AnglesOfTracks angles_deg) : angles_deg_(std::move(angles_deg)) {}

  std::span<const StepRecord> step(const Measurement& measurement) override {
    records_.clear();
    for (const auto& [track, angles] : angles_deg_) {
      const double angle = angles[step_];
      if (!(angle == angle)) continue;
      StepRecord record;
      record.track = track;
      record.time_s = measurement.time_s;
      record.space = &angle_space();
      record.x = Eigen::Vector2d(radians(angle), 0.0);
      record.P = BoundedMatrix::Identity(2, 2) * radians(1.0) * radians(1.0);
      record.innovation = Innovation{BoundedVector::Zero(1), BoundedVector::Constant(1, angle),
                                     BoundedMatrix::Identity(1, 1), angle * angle};
      records_.push_back(record);
    }
    ++step_;
    return records_;
  }
  void reset() override { step_ = 0; }
  std::unique_ptr<Tracker> fresh() const override { return std::make_unique<ToldTracker>(angles_deg_); }
  const StateSpace& space() const override { return angle_space(); }
  RecordBlocks blocks() const override { return {.innovation = true}; }

 private:
  AnglesOfTracks angles_deg_;
  std::size_t step_ = 0;
  std::vector<StepRecord> records_;
};

}  // namespace truebearing::testing
