// SPDX-License-Identifier: Apache-2.0
// A target seen in bearings and heard at a frequency: the small cast of the tests of passive sonar.
#pragma once

#include <cmath>

#include "tests/support/bearings.hpp"
#include "truebearing/motion/constant_velocity.hpp"
#include "truebearing/motion/with_frequency.hpp"
#include "truebearing/tracker/bearing_frequency_sensor.hpp"

namespace truebearing::testing {

using FrequencyMotion = WithFrequency<ConstantVelocity<2, ContinuousWhiteNoise>>;

inline constexpr double kSource_hz = 120.0;
inline const BearingFrequencySensor kFrequencySensor{radians(1.0), 0.02};

/// The run of bearings_run() with the frequency of a source that jumps by `jump_hz` at jump_s; truth in
/// plane_frequency_space().
inline Recording frequency_run(std::uint64_t run, int steps = 100, double jump_hz = 0.0, double jump_s = 1e9) {
  Recording recording = bearings_run(run, steps);
  recording.measured = {"bearing_deg", "frequency_hz"};
  recording.truth_space = &plane_frequency_space();
  RandomStream noise({.seed = 8, .role = Role::evaluation, .run = run}, StreamId::test);
  for (std::size_t k = 0; k < recording.measurements.size(); ++k) {
    Measurement& m = recording.measurements[k];
    BearingFrequency<>::State x;
    x << recording.truth[0].x[k], kSource_hz + (m.time_s >= jump_s ? jump_hz : 0.0);
    recording.truth[0].x[k] = x;
    const BearingFrequency<> model{m.sensor->position_m, m.sensor->velocity_mps, m.sigma[0], kFrequencySensor.sigma_hz};
    m.z = Eigen::Vector2d(m.z[0], model.h(x)(1) + kFrequencySensor.sigma_hz * noise.normal());
    m.sigma = Eigen::Vector2d(m.sigma[0], kFrequencySensor.sigma_hz);
  }
  return recording;
}

}  // namespace truebearing::testing
