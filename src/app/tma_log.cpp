// SPDX-License-Identifier: Apache-2.0
#include "app/tma_log.hpp"

#include <cmath>
#include <fmt/format.h>

#include "truebearing/core/angle.hpp"
#include "truebearing/core/error.hpp"

namespace truebearing {
namespace {

void add_frequency(const Measurement& measurement, const TmaArguments& options, DopplerWindow& window) {
  if (measurement.sigma.size() == 0 && !(options.frequency_sigma_hz > 0.0))
    throw InputError(options.log, "does not say how good its frequencies are",
                     "a column frequency_sigma_hz, --frequency-sigma, or --bearings-only");
  const double sigma_hz = options.frequency_sigma_hz > 0.0 ? options.frequency_sigma_hz : measurement.sigma[1];
  window.add(measurement.time_s, measurement.z[1], sigma_hz, *measurement.sensor);
}

// Without own ship's velocity its own share of the Doppler shift would be taken for the target's.
void check_velocities(const DopplerWindow& window, const std::string& log) {
  bool at_rest = true, moved = false;
  for (std::size_t i = 0; i < window.size(); ++i) {
    at_rest = at_rest && window.sensor(i).velocity_mps.isZero(0.0);
    moved = moved || window.sensor(i).position_m != window.sensor(0).position_m;
  }
  if (at_rest && moved)
    throw InputError(log, "has frequencies of a sensor that moves, and not its velocity",
                     "columns sensor_east_mps, sensor_north_mps, or --bearings-only");
}

}  // namespace

Recording read_tma_log(const TmaArguments& options) {
  LogFindings findings;
  RecordingOptions wanted;
  wanted.measured = {"bearing_deg", "frequency_hz"};
  Recording recording = read_recording(options.log, options.reading.over(wanted), &findings);
  print_note(options.log, findings.note());
  const bool has_frequencies = recording.measured == std::vector<std::string>{"bearing_deg", "frequency_hz"};
  if (!has_frequencies && recording.measured != std::vector<std::string>{"bearing_deg"})
    throw InputError(options.log, fmt::format("measures {}", fmt::join(recording.measured, ", ")),
                     "bearing_deg, or bearing_deg and frequency_hz in this order");
  if (has_frequencies && options.is_cho() && !options.bearings_only)
    throw InputError(options.log, "has frequencies, which --method " + options.method + " takes no notice of",
                     "--method ml or map, or --bearings-only");
  if (recording.truth_space && !begins_in_plane(*recording.truth_space))
    throw InputError(options.log, "has a truth that is not in the plane", "truth_east_m, truth_north_m");
  return recording;
}

TmaWindows tma_windows(const Recording& recording, const TmaArguments& options, TmaAnswer& answer) {
  TmaWindows windows{{}, DopplerWindow(options.sound_mps), {}, {}, {}};
  const bool has_frequencies = recording.measured.size() == 2 && !options.bearings_only;
  for (std::size_t k = 0; k < recording.measurements.size(); ++k) {
    const Measurement& measurement = recording.measurements[k];
    if (measurement.time_s < options.from_s || measurement.time_s > options.to_s) continue;
    const bool has_bearing = std::isfinite(measurement.z[0]);
    const bool has_frequency = has_frequencies && std::isfinite(measurement.z[1]) && measurement.z[1] > 0.0;
    answer.missing += !has_bearing;
    answer.missing_frequencies += has_frequencies && !has_frequency;
    if (!has_bearing && !has_frequency) continue;
    if (!measurement.sensor)
      throw InputError(options.log, "does not say where own ship was", "columns sensor_east_m, sensor_north_m");
    if (has_frequency) {
      add_frequency(measurement, options, windows.frequencies);
      windows.frequency_line.push_back(recording.line[k]);
    }
    if (!has_bearing) continue;
    if (measurement.sigma.size() == 0 && !(options.sigma_deg > 0.0))
      throw InputError(options.log, "does not say how good its bearings are", "a column bearing_sigma_deg, or --sigma");
    const double sigma_rad = options.sigma_deg > 0.0 ? radians(options.sigma_deg) : measurement.sigma[0];
    windows.bearings.add(measurement.time_s, measurement.z[0], sigma_rad, measurement.sensor->position_m);
    windows.own_ship.push_back(*measurement.sensor);
    windows.line.push_back(recording.line[k]);
    answer.own_ship = *measurement.sensor;
    if (recording.truth_space && recording.truth[0].x[k].head<4>().allFinite()) answer.truth = recording.truth[0].x[k];
  }
  constexpr std::size_t kFewest = 5;
  if (windows.bearings.size() < kFewest)
    throw InputError(options.log, fmt::format("has {} usable bearings in that time", windows.bearings.size()),
                     fmt::format("{} or more", kFewest));
  if (!(windows.bearings.last_time_s() > windows.bearings.first_time_s()))
    throw InputError(options.log, "has all its bearings at one time", "bearings over a time");
  check_velocities(windows.frequencies, options.log);
  return windows;
}

}  // namespace truebearing
