// SPDX-License-Identifier: Apache-2.0
// write_recording(): the text of a log.
#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

#include "truebearing/core/constants.hpp"
#include "truebearing/core/error.hpp"
#include "truebearing/recording/log_units.hpp"
#include "truebearing/recording/recording_csv.hpp"

namespace truebearing {
namespace {

constexpr std::array<const char*, 4> kSensorColumns{"sensor_east_m", "sensor_north_m", "sensor_east_mps",
                                                    "sensor_north_mps"};
constexpr std::array<const char*, 2> kHeightColumns{"sensor_up_m", "sensor_up_mps"};
constexpr std::array<const char*, 4> kGuessColumns{"guess_range_m", "guess_range_sigma_m", "guess_speed_mps",
                                                   "guess_speed_sigma_mps"};

std::vector<double> file_factors(const std::vector<std::string>& names) {
  std::vector<double> factors;
  for (const std::string& name : names) {
    const Unit* unit = apart(name).unit;
    if (lorenz_space().component_index(name) >= 0) {
      factors.push_back(1.0);
      continue;
    }
    if (!unit) throw InputError(name, "names no known unit", "a name that ends in " + all_suffixes());
    factors.push_back(unit->factor);
  }
  return factors;
}

void write_vector(CsvWriter& csv, const BoundedVector& values, const std::vector<double>& factors) {
  for (std::size_t i = 0; i < factors.size(); ++i)
    csv.number(values.size() > 0 ? values(static_cast<Eigen::Index>(i)) / factors[i] : kNaN);
}

// `values` of the components of a measurement's own sensor, at their places among all that is measured.
BoundedVector among_all(const Recording& recording, const Measurement& measurement, const BoundedVector& values) {
  if (recording.sources.empty() || values.size() == 0) return values;
  const std::vector<std::string>&own = components_of(recording, measurement), &all = recording.measured;
  BoundedVector spread = BoundedVector::Constant(static_cast<Eigen::Index>(all.size()), kNaN);
  for (Eigen::Index i = 0; i < values.size(); ++i)
    spread[std::find(all.begin(), all.end(), own[static_cast<std::size_t>(i)]) - all.begin()] = values[i];
  return spread;
}

}  // namespace

std::string write_recording(const Recording& recording) {
  if (recording.truth.size() > 1)
    throw InputError("recording", fmt::format("has {} true tracks", recording.truth.size()), "at most one in a log");
  const auto any = [&](const auto& predicate) {
    return std::any_of(recording.measurements.begin(), recording.measurements.end(), predicate);
  };
  const bool has_sigma = any([](const Measurement& m) { return m.sigma.size() > 0; });
  const bool has_sensor = any([](const Measurement& m) { return m.sensor.has_value(); });
  // Of targets in the plane a height of 0 says nothing.
  const bool looks_up =
      std::find(recording.measured.begin(), recording.measured.end(), "elevation_deg") != recording.measured.end();
  const bool has_height = any([&](const Measurement& m) {
    return m.sensor && std::isfinite(m.sensor->up_m) && (looks_up || m.sensor->up_m != 0.0);
  });
  const bool has_guess = any([](const Measurement& m) { return m.guess.has_value(); });
  const bool has_speed = any([](const Measurement& m) { return m.guess && std::isfinite(m.guess->speed_mps); });
  const auto guess_end = has_speed ? kGuessColumns.end() : kGuessColumns.begin() + 2;
  const bool has_truth = !recording.truth.empty();
  const std::vector<double> z_factors = file_factors(recording.measured);
  const std::vector<double> x_factors = has_truth ? file_factors(recording.truth_space->components) : z_factors;

  std::vector<std::string> header{"time_s"};
  if (!recording.sources.empty()) header.emplace_back("sensor");
  header.insert(header.end(), recording.measured.begin(), recording.measured.end());
  if (has_sigma)
    for (const std::string& name : recording.measured) header.push_back(sigma_name(name));
  if (has_sensor) header.insert(header.end(), kSensorColumns.begin(), kSensorColumns.end());
  if (has_height) header.insert(header.end(), kHeightColumns.begin(), kHeightColumns.end());
  if (has_guess) header.insert(header.end(), kGuessColumns.begin(), guess_end);
  if (has_truth)
    for (const std::string& component : recording.truth_space->components) header.push_back("truth_" + component);

  CsvWriter csv(header);
  for (std::size_t k = 0; k < recording.measurements.size(); ++k) {
    const Measurement& measurement = recording.measurements[k];
    csv.number(measurement.time_s);
    if (!recording.sources.empty()) csv.text(recording.sources[static_cast<std::size_t>(measurement.source)].name);
    write_vector(csv, among_all(recording, measurement, measurement.z), z_factors);
    if (has_sigma) write_vector(csv, among_all(recording, measurement, measurement.sigma), z_factors);
    if (has_sensor) {
      const Eigen::Vector2d unknown = Eigen::Vector2d::Constant(kNaN);
      const SensorState sensor = measurement.sensor.value_or(SensorState{unknown, unknown, kNaN, kNaN});
      for (const double value : sensor.position_m) csv.number(value);
      for (const double value : sensor.velocity_mps) csv.number(value);
      if (has_height) csv.number(sensor.up_m);
      if (has_height) csv.number(sensor.climb_mps);
    }
    if (has_guess) {
      const TargetGuess guess = measurement.guess.value_or(TargetGuess{kNaN, kNaN});
      csv.number(guess.range_m);
      csv.number(guess.range_sigma_m);
      if (has_speed) csv.number(guess.speed_mps);
      if (has_speed) csv.number(guess.speed_sigma_mps);
    }
    if (has_truth) write_vector(csv, recording.truth[0].x[k], x_factors);
    csv.end_row();
  }
  return csv.str();
}

}  // namespace truebearing
