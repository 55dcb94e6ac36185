// SPDX-License-Identifier: Apache-2.0
#include "app/tma_log.hpp"

#include <algorithm>
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

// From one bearing to a later one: how far own ship went by its positions, and how far by its velocity.
struct OwnShipStep {
  Eigen::Vector2d went_m, sailed_m;
  double time_s;
  std::size_t to;  // that bearing
  double off_m() const { return (went_m - sailed_m).norm(); }
};

std::vector<OwnShipStep> steps_of(const TmaWindows& windows) {
  std::vector<OwnShipStep> steps;
  for (std::size_t i = 1; i < windows.own_ship.size(); ++i) {
    const SensorState &from = windows.own_ship[i - 1], &to = windows.own_ship[i];
    const double time_s = windows.bearings.time_s(i) - windows.bearings.time_s(i - 1);
    steps.push_back({to.position_m - from.position_m, 0.5 * time_s * (from.velocity_mps + to.velocity_mps), time_s, i});
  }
  return steps;
}

// What a factor between positions and velocities comes from.
std::string unit_behind(double factor) {
  struct Unit {
    double factor;
    const char* says;
  };
  for (const Unit& unit :
       {Unit{1e-3, "are the positions in kilometres?"}, Unit{1.0 / 1852.0, "are the positions in nautical miles?"},
        Unit{1.0 / 0.3048, "are the positions in feet?"}, Unit{1852.0 / 3600.0, "is the velocity in knots?"},
        Unit{1.0 / 3.6, "is the velocity in km/h?"}, Unit{1e3, "is the velocity in km/s, or are the positions in mm?"}})
    if (std::abs(factor / unit.factor - 1.0) < 0.06) return unit.says;
  return "is one of them in another unit?";
}

// All the way: positions are some multiple of what they should be, and nothing else is wrong with them.
std::string factor_of(const std::vector<OwnShipStep>& steps) {
  constexpr double kGross = 1.67, kUnexplained = 0.04;
  double both = 0.0, sailed = 0.0, went = 0.0;
  for (const OwnShipStep& step : steps) {
    both += step.went_m.dot(step.sailed_m);
    sailed += step.sailed_m.squaredNorm();
    went += step.went_m.squaredNorm();
  }
  const double factor = both / sailed;
  if (!(factor > 0.0) || (factor < kGross && factor > 1.0 / kGross)) return {};
  if (went - both * factor > kUnexplained * went) return {};
  return fmt::format(
      "own ship's positions (sensor_east_m, sensor_north_m) change {:.3g} times as fast as its velocity "
      "(sensor_east_mps, sensor_north_mps) says: {}",
      factor, unit_behind(factor));
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// At a few places: farther than own ship can have sailed, and than its positions are uncertain.
std::string jump_of(const std::vector<OwnShipStep>& steps, const TmaWindows& windows) {
  constexpr double kTimesAsFast = 5.0, kOfUsual = 20.0, kLeast_m = 1.0, kMostOfAll = 0.1;
  std::vector<double> off_m;
  double fastest_mps = 0.0;
  for (const OwnShipStep& step : steps) off_m.push_back(step.off_m());
  for (const SensorState& own_ship : windows.own_ship)
    fastest_mps = std::max(fastest_mps, own_ship.velocity_mps.norm());
  const double usual_m = median(off_m);
  std::vector<const OwnShipStep*> jumps;
  for (const OwnShipStep& step : steps)
    if (step.off_m() > std::max({kTimesAsFast * fastest_mps * step.time_s, kOfUsual * usual_m, kLeast_m}))
      jumps.push_back(&step);
  if (jumps.empty() || static_cast<double>(jumps.size()) > kMostOfAll * static_cast<double>(steps.size())) return {};
  const OwnShipStep& worst = **std::max_element(jumps.begin(), jumps.end(),
                                                [](const auto* a, const auto* b) { return a->off_m() < b->off_m(); });
  return fmt::format(
      "own ship's position jumps by {:.0f} m between {} s (line {}) and {} s (line {}){}, where its velocity makes "
      "{:.0f} m",
      worst.went_m.norm(), seconds(windows.bearings.time_s(worst.to - 1)), windows.line[worst.to - 1],
      seconds(windows.bearings.time_s(worst.to)), windows.line[worst.to],
      jumps.size() > 1 ? fmt::format(" and at {} more times", jumps.size() - 1) : "", worst.sailed_m.norm());
}

}  // namespace

std::string own_ship_is_off(const TmaWindows& windows) {
  const bool has_velocity = std::any_of(windows.own_ship.begin(), windows.own_ship.end(),
                                        [](const auto& own_ship) { return !own_ship.velocity_mps.isZero(0.0); });
  if (!has_velocity) return {};
  const std::vector<OwnShipStep> steps = steps_of(windows);
  const std::string jump = jump_of(steps, windows);
  return jump.empty() ? factor_of(steps) : jump;
}

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
