// SPDX-License-Identifier: Apache-2.0
// What holds of every tracker, whatever it is given: what it publishes is finite or `failed`, and no variance is below
// zero. For random streams (property/hostile_streams_test.cpp) and for those that a fuzzer makes (fuzz/estimators.cpp).
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <deque>
#include <fmt/format.h>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "truebearing/core/constants.hpp"
#include "truebearing/core/random.hpp"
#include "truebearing/tracker/tracker.hpp"

namespace truebearing::testing {

/// Measurements, and the snapshots that those of a line array look at.
struct Stream {
  std::vector<Measurement> measurements;
  std::deque<std::vector<std::complex<double>>> snapshots;

  /// A block of the last measurement, of as many zeros.
  std::vector<std::complex<double>>& add_block(int sensors, int count, double spacing_wavelengths, double interval_s) {
    auto& values = snapshots.emplace_back(static_cast<std::size_t>(sensors) * static_cast<std::size_t>(count));
    measurements.back().snapshots = SnapshotBlock{values, sensors, spacing_wavelengths, interval_s};
    return values;
  }
};

/// Row k, from 1, of a log in which nothing is wrong: a number for each component, of a target that is nowhere in
/// particular; or what so many sensors of a line array hear of one target that stands still, ten times as strong as the
/// noise.
inline void add_tame_row(int k, Eigen::Index components, int sensors, RandomStream& random, Stream& stream) {
  constexpr int kSnapshots = 30;
  Measurement& measurement = stream.measurements.emplace_back();
  measurement.time_s = 20.0 * k;
  if (sensors > 0) {
    measurement.time_s = k;
    constexpr double kPhase_rad = 0.5;  // from one sensor to the next
    std::vector<std::complex<double>>& values = stream.add_block(sensors, kSnapshots, 0.5, 1.0);
    for (int t = 0; t < kSnapshots; ++t) {
      const std::complex<double> signal = std::sqrt(10.0) * std::complex<double>(random.normal(), random.normal());
      for (int m = 0; m < sensors; ++m)
        values[static_cast<std::size_t>(t * sensors + m)] =
            signal * std::polar(1.0, kPhase_rad * m) + std::complex<double>(random.normal(), random.normal());
    }
    return;
  }
  measurement.z = BoundedVector::NullaryExpr(components, [&] { return 0.3 * random.normal() + 1.0; });
  measurement.sensor = SensorState{Eigen::Vector2d(100.0 * k, 3000.0 * std::sin(0.1 * k)), Eigen::Vector2d(5.0, 0.0)};
  measurement.guess = TargetGuess{8000.0, 2000.0, 5.0, 2.0};
}

/// What was published, a row of numbers for each record; and the first thing about it that must not be.
struct Published {
  std::vector<std::vector<double>> rows;
  std::string fault;

  void add(const StepRecord& record) {
    std::vector<double> row{static_cast<double>(record.track), static_cast<double>(record.status), record.time_s};
    row.insert(row.end(), record.x.begin(), record.x.end());
    for (const double value : record.P.reshaped()) row.push_back(value);
    rows.push_back(std::move(row));
    if (record.status == StepStatus::failed || !fault.empty()) return;
    const bool is_finite = record.x.allFinite() && record.P.allFinite();
    if (is_finite && (record.P.diagonal().array() >= 0.0).all()) return;
    fault = fmt::format("at {} s: x = {}, variances {}", record.time_s, fmt::join(record.x, ", "),
                        fmt::join(BoundedVector(record.P.diagonal()), ", "));
  }

  /// The same bits, where one NaN is like another.
  bool operator==(const Published& other) const {
    const auto is_same = [](double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); };
    return std::equal(
        rows.begin(), rows.end(), other.rows.begin(), other.rows.end(),
        [&](const auto& a, const auto& b) { return std::equal(a.begin(), a.end(), b.begin(), b.end(), is_same); });
  }
};

inline Published published(Tracker& tracker, std::span<const Measurement> measurements) {
  Published all;
  for (const Measurement& measurement : measurements)
    for (const StepRecord& record : tracker.step(measurement)) all.add(record);
  return all;
}

/// The measurement's row with nothing in it but where the sensor was, at that time.
inline Measurement emptied(const Measurement& measurement, double time_s) {
  Measurement empty = measurement;
  empty.time_s = time_s;
  empty.z.setConstant(kNaN);
  empty.guess.reset();
  empty.snapshots.reset();
  return empty;
}

}  // namespace truebearing::testing
