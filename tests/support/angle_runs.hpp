// SPDX-License-Identifier: Apache-2.0
// Runs of a line array for the tests of trackers of angles: of scenarios in data/, and of targets that are written
// down.
#pragma once

#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "tests/support/array_scene.hpp"
#include "truebearing/simulation/scenario.hpp"
#include "truebearing/tracker/tracker.hpp"

namespace truebearing::testing {

inline Recording array_run(const std::string& name, std::uint64_t run = 0) {
  return load_scenario(std::filesystem::path(TRUEBEARING_SOURCE_DIR) / "data/scenarios" / (name + ".toml"))
      ->simulate({1, Role::evaluation, run});
}

/// Intervals of 1 s that end at 0, 1, ... s, of what scene_at(k) says of interval k; the truth stays with the caller.
inline Recording recording_of(int intervals, std::uint64_t run, const std::function<ArrayScene(int)>& scene_at) {
  RandomStream random({31, Role::evaluation, run}, StreamId::test);
  Recording recording;
  recording.measured = {"snapshots"};
  auto values = std::make_shared<Snapshots>();
  std::vector<ArrayScene> scenes;
  for (int k = 0; k < intervals; ++k) {
    scenes.push_back(scene_at(k));
    const Snapshots drawn = scenes.back().draw(random);
    values->insert(values->end(), drawn.begin(), drawn.end());
  }
  std::size_t begin = 0;
  for (int k = 0; k < intervals; ++k) {
    const ArrayScene& scene = scenes[static_cast<std::size_t>(k)];
    const std::size_t size = static_cast<std::size_t>(scene.sensors * scene.snapshots);
    Measurement measurement;
    measurement.time_s = k;
    measurement.snapshots = {std::span<const std::complex<double>>(*values).subspan(begin, size), scene.sensors,
                             scene.spacing_wavelengths, 1.0};
    recording.measurements.push_back(measurement);
    begin += size;
  }
  recording.snapshots = values;
  return recording;
}

/// The same recording with its snapshots changed: change(interval, values of that interval).
inline Recording changed(const Recording& recording,
                         const std::function<void(std::size_t, std::span<std::complex<double>>)>& change) {
  Recording other = recording;
  auto values = std::make_shared<Snapshots>(*recording.snapshots);
  for (std::size_t k = 0; k < other.measurements.size(); ++k) {
    SnapshotBlock& block = *other.measurements[k].snapshots;
    const auto begin = static_cast<std::size_t>(block.values.data() - recording.snapshots->data());
    const std::span<std::complex<double>> part = std::span(*values).subspan(begin, block.values.size());
    change(k, part);
    block.values = part;
  }
  other.snapshots = values;
  return other;
}

/// What a tracker published at each step, copied.
using Published = std::vector<std::vector<StepRecord>>;
inline Published track(Tracker& tracker, const std::vector<Measurement>& measurements) {
  Published published;
  for (const Measurement& measurement : measurements) {
    const auto records = tracker.step(measurement);
    published.emplace_back(records.begin(), records.end());
  }
  return published;
}

/// Mean squared error of the angles in degrees^2 from step `from` on, and the largest error of the last step: record n
/// is of true track n.
struct AngleErrors {
  double mse_deg2 = 0.0, last_deg = 0.0;
};
inline AngleErrors angle_errors(const Published& published, const Recording& recording, std::size_t from = 3) {
  AngleErrors errors;
  double count = 0.0;
  for (std::size_t k = from; k < published.size(); ++k)
    for (const StepRecord& record : published[k]) {
      const double error = degrees(record.x[0] - recording.truth[static_cast<std::size_t>(record.track)].x[k][0]);
      errors.mse_deg2 += error * error;
      count += 1.0;
      if (k + 1 == published.size()) errors.last_deg = std::max(errors.last_deg, std::abs(error));
    }
  errors.mse_deg2 = count > 0.0 ? errors.mse_deg2 / count : std::numeric_limits<double>::quiet_NaN();
  return errors;
}

}  // namespace truebearing::testing
