// SPDX-License-Identifier: Apache-2.0
// A canvas: what is drawn of states of one space, of measurements and of records.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "truebearing/evaluation/run_picture.hpp"
#include "truebearing/evaluation/sensor_sites.hpp"

namespace truebearing {

/// In the plane where the space begins with one, of a target in space along the ground, else its first component over time.
class RunCanvas {
 public:
  /// The space must outlive it.
  explicit RunCanvas(const StateSpace& space);

  bool in_plane() const { return plane_; }
  const std::string& component() const { return component_; }
  double scale() const { return scale_; }

  void add(double time_s, const BoundedVector& x, DrawnLine& line) const;
  /// A record of another space than the canvas's is drawn where it has the same components.
  void add(const StepRecord& record, DrawnTrack& track) const;

  /// The measurements of a recording. Bearings are clockwise from North, seen from where they say, else from the sites.
  void add_measured(const Recording& recording, const SensorSites& sites, RunPicture& picture) const;
  /// What a line array heard, where the recording is of one: at no more than some hundred of its times.
  void add_beam(const Recording& recording, RunPicture& picture) const;
  /// Records of a tracker of that name, each to the end of its track's line.
  void add_records(std::span<const StepRecord> records, const std::string& name, std::vector<DrawnTrack>& tracks) const;

 private:
  const StateSpace& space_;
  bool plane_;
  std::string component_;
  double scale_ = 1.0;
};

}  // namespace truebearing
