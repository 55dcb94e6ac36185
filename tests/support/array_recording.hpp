// SPDX-License-Identifier: Apache-2.0
// A short recording of a line array with two targets, for tests of what carries it.
#pragma once

#include <complex>
#include <memory>
#include <vector>

#include "truebearing/core/constants.hpp"
#include "truebearing/core/random.hpp"
#include "truebearing/recording/recording.hpp"

namespace truebearing::testing {

/// Noise heard by 3 sensors: 4 intervals of 2 snapshots, of which one sensor misses one and interval 2 all. Of two
/// targets the second comes later.
inline Recording array_recording() {
  constexpr std::size_t kSensors = 3, kSnapshots = 2, kIntervals = 4, kSize = kSensors * kSnapshots;
  RandomStream random({.seed = 3}, StreamId::test);
  auto values = std::make_shared<std::vector<std::complex<double>>>(kIntervals * kSize);
  for (std::complex<double>& value : *values) value = {random.normal(), 1e-300 * random.normal()};
  (*values)[4] = {kNaN, 1.0};
  for (std::size_t i = 2 * kSize; i < 3 * kSize; ++i) (*values)[i] = {kNaN, kNaN};
  Recording recording;
  recording.measured = {"snapshots"};
  recording.truth_space = &angle_space();
  recording.truth = {{.track = 0, .x = {}, .phase = {}}, {.track = 1, .x = {}, .phase = {}}};
  for (std::size_t k = 0; k < kIntervals; ++k) {
    Measurement measurement;
    measurement.time_s = 0.1 + 0.3 * static_cast<double>(k);
    measurement.snapshots = {std::span<const std::complex<double>>(*values).subspan(k * kSize, kSize), kSensors, 0.47,
                             0.3};
    recording.measurements.push_back(measurement);
    recording.truth[0].x.emplace_back(Eigen::Vector2d(0.1 + 0.01 * static_cast<double>(k), 0.033));
    recording.truth[1].x.emplace_back(k < 2 ? Eigen::Vector2d(kNaN, kNaN) : Eigen::Vector2d(-0.7, -0.001));
  }
  recording.counts.missing = 1;
  recording.snapshots = values;
  return recording;
}

}  // namespace truebearing::testing
