// SPDX-License-Identifier: Apache-2.0
// Several targets told apart by their angles, and a tracker that says of them what it is told to: for the tests of
// everything that stands behind a tracker of several targets.
#pragma once

#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "tests/support/fakes.hpp"
#include "truebearing/core/angle.hpp"

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

/// Publishes those angles, each with a rate of 0 and a standard deviation of 1 degree; no record where one is NaN.
inline std::unique_ptr<Tracker> told_tracker(AnglesOfTracks angles_deg) {
  const auto say = [angles_deg = std::move(angles_deg)](const Measurement& measurement, std::size_t step,
                                                        FakeTracker::Said& said) {
    for (const auto& [track, angles] : angles_deg) {
      const double angle = angles[step];
      if (!(angle == angle)) continue;
      said.records.push_back(fake_record(angle_space(), measurement, Eigen::Vector2d(radians(angle), 0.0),
                                         BoundedMatrix::Identity(2, 2) * radians(1.0) * radians(1.0)));
      said.records.back().track = track;
      said.records.back().innovation = Innovation{BoundedVector::Zero(1), BoundedVector::Constant(1, angle),
                                                  BoundedMatrix::Identity(1, 1), angle * angle};
    }
  };
  return std::make_unique<FakeTracker>(angle_space(), say, RecordBlocks{.innovation = true});
}

}  // namespace truebearing::testing
