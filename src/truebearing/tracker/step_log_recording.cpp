// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tracker/step_log_recording.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <limits>
#include <memory>
#include <utility>

#include "truebearing/core/error.hpp"
#include "truebearing/core/suggestion.hpp"
#include "truebearing/recording/velocity_truth.hpp"

namespace truebearing {
namespace {

std::vector<std::string> numbered_names(std::size_t size) {
  std::vector<std::string> names;
  for (std::size_t i = 1; i <= size; ++i) names.push_back(fmt::format("z_{}", i));
  return names;
}

// A log does not name what it measures: the positions of the state, where there are as many.
std::vector<std::string> measured_names(const StateSpace& space, std::size_t size) {
  const int position = space.quantity_index("position_m");
  std::vector<std::string> names;
  if (position >= 0)
    for (const int index : space.quantities[static_cast<std::size_t>(position)].indices)
      names.push_back(space.components[static_cast<std::size_t>(index)]);
  return names.size() == size ? names : numbered_names(size);
}

// The rows of one track of the log.
StepLog part_of(const StepLog& log, int track) {
  StepLog part;
  part.space = log.space;
  part.has_innovation = log.has_innovation;
  part.truth_components = log.truth_components;
  for (std::size_t k = 0; k < log.records.size(); ++k) {
    if (log.records[k].track != track) continue;
    part.records.push_back(log.records[k]);
    part.records.back().track = 0;
    part.z.push_back(log.z[k]);
    part.truth.push_back(log.truth[k]);
  }
  return part;
}

void add_truth(const StepLog& log, Recording& recording) {
  const StateSpace& space = *log.space;
  recording.truth_space = &space;
  recording.truth.resize(1);
  std::vector<BoundedVector>& x = recording.truth[0].x;
  std::vector<bool> given(space.components.size(), false);
  std::vector<double> time_s;
  for (const StepRecord& record : log.records) {
    time_s.push_back(record.time_s);
    x.push_back(BoundedVector::Constant(space.size(), std::numeric_limits<double>::quiet_NaN()));
  }
  for (std::size_t i = 0; i < log.truth_components.size(); ++i) {
    const int component = space.component_index(log.truth_components[i]);
    given[static_cast<std::size_t>(component)] = true;
    for (std::size_t k = 0; k < x.size(); ++k) x[k](component) = log.truth[k](static_cast<Eigen::Index>(i));
  }
  complete_velocities(space, given, time_s, x);
}

Recording make_recording(StepLog part) {
  const auto log = std::make_shared<const StepLog>(std::move(part));
  Recording recording;
  recording.steps = log;
  // Of sensors of several sizes none is taken for positions.
  const auto [least, most] = std::minmax_element(log->z.begin(), log->z.end(),
                                                 [](const auto& a, const auto& b) { return a.size() < b.size(); });
  recording.measured = least->size() == most->size()
                           ? measured_names(*log->space, static_cast<std::size_t>(most->size()))
                           : numbered_names(static_cast<std::size_t>(most->size()));
  for (std::size_t k = 0; k < log->records.size(); ++k) {
    Measurement measurement;
    measurement.time_s = log->records[k].time_s;
    measurement.z = log->z[k];
    measurement.recorded = &log->records[k];
    recording.counts.missing += measurement.is_missing();
    recording.measurements.push_back(std::move(measurement));
  }
  if (!log->truth_components.empty()) add_truth(*log, recording);
  return recording;
}

}  // namespace

std::vector<RecordedTrack> recordings_of(const StepLog& log, const std::string& name) {
  for (const std::string& component : log.truth_components)
    if (log.space->component_index(component) < 0)
      throw InputError(name + ": truth_" + component, "is no component of the state",
                       suggestion(component, log.space->components));
  std::vector<RecordedTrack> tracks;
  for (const StepRecord& record : log.records) {
    const auto known = [&](const RecordedTrack& track) { return track.track == record.track; };
    if (std::any_of(tracks.begin(), tracks.end(), known)) continue;
    tracks.push_back({record.track, make_recording(part_of(log, record.track))});
  }
  return tracks;
}

}  // namespace truebearing
