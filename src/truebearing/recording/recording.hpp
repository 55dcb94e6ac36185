// SPDX-License-Identifier: Apache-2.0
// A recording: what a sensor measured over time and, where it is known, the truth beside it. The simulator makes
// recordings and measurement logs are read into them, so that trackers cannot tell the two apart.
#pragma once

#include <complex>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "truebearing/core/bounded.hpp"
#include "truebearing/core/state_space.hpp"
#include "truebearing/measurement/measured.hpp"
#include "truebearing/measurement/measurement.hpp"

namespace truebearing {

struct StepLog;

/// The true states of one target at the times of the measurements; NaN components where the truth is unknown.
struct Truth {
  int track = 0;
  std::vector<BoundedVector> x;
  std::vector<int> phase;  ///< what the target was doing, by place in Recording::phases, -1 for what is none of them;
                           ///< empty where that is not told
  /// When it first leaves its course; infinite where it keeps it to the end, nothing where that is not told.
  std::optional<double> turns_at_s = std::nullopt;
  /// Of what an array hears of it: the power of its signal over that of a sensor's noise.
  std::optional<double> snr = std::nullopt;
};

struct Recording {
  /// Names of the components of z with units: "position_m"; of a line array "snapshots".
  std::vector<std::string> measured;
  /// Of several sensors, by Measurement::source, whose z has the components of its own; empty where there is one.
  std::vector<Source> sources{};
  std::vector<Measurement> measurements;
  std::vector<std::size_t> line;            ///< of the file that each was read from, from 1; empty where there is none
  const StateSpace* truth_space = nullptr;  ///< nullptr where there is no truth
  std::vector<Truth> truth;                 ///< one per target; each as long as `measurements`
  std::vector<std::string> phases;          ///< names of what targets do, for the report: "manoeuvre", "quiet"

  /// What was found and mended while a log was read.
  struct Counts {
    int missing = 0;           ///< rows without a usable measurement
    int repeated = 0;          ///< rows identical to the one before, dropped
    int glitches = 0;          ///< of the missing, those whose position implied an impossible speed
    int wrong_velocities = 0;  ///< rows that say an impossible velocity, which is not believed
  } counts;

  /// Owns the values of the measurements' snapshots; nothing where there are none.
  std::shared_ptr<const std::vector<std::complex<double>>> snapshots;
  std::shared_ptr<const StepLog> steps;  ///< owns what `recorded` of the measurements points to; mostly empty
};

/// What that measurement's z is made of.
inline const std::vector<std::string>& components_of(const Recording& recording, const Measurement& measurement) {
  if (recording.sources.empty()) return recording.measured;
  return recording.sources[static_cast<std::size_t>(measurement.source)].components;
}

/// Whether z holds a bearing and the frequency heard with it, either of which may come alone.
inline bool measures_bearing_and_frequency(const std::vector<std::string>& measured) {
  return measured.size() == 2 && measured[0] == "bearing_deg" && measured[1] == "frequency_hz";
}

/// Whether it is a line array's.
inline bool measures_snapshots(const std::vector<std::string>& measured) {
  return measured.size() == 1 && measured[0] == "snapshots";
}

/// Whether there is nothing in a measurement of the recording that a tracker could use.
inline bool is_unusable(const Recording& recording, const Measurement& measurement) {
  if (measures_snapshots(recording.measured))
    return !measurement.snapshots || !measurement.snapshots->has_usable_snapshot();
  if (!measures_bearing_and_frequency(components_of(recording, measurement))) return measurement.is_missing();
  return measurement.z.size() == 0 || measurement.z.array().isNaN().all();
}

}  // namespace truebearing
