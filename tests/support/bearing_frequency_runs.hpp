// SPDX-License-Identifier: Apache-2.0
// Bearings and frequencies for tests: Kim and Song's scenario. Angles are compass courses: so the bound at 1050 s is
// 155 m with frequencies and 531 m without.
#pragma once

#include <cmath>
#include <functional>
#include <limits>

#include "truebearing/core/angle.hpp"
#include "truebearing/core/random.hpp"
#include "truebearing/simulation/vessel.hpp"
#include "truebearing/tma/bearing_window.hpp"
#include "truebearing/tma/doppler_window.hpp"

namespace truebearing::testing {

struct BearingFrequencyWindows {
  BearingWindow bearings;
  DopplerWindow frequencies;
};

/// f0 as a function of time: 100 Hz, and more from begin_s to end_s.
inline std::function<double(double)> jump(double by_hz, double begin_s = 600.0,
                                          double end_s = std::numeric_limits<double>::infinity()) {
  return [=](double t) { return 100.0 + (t >= begin_s && t < end_s ? by_hz : 0.0); };
}

struct KimSong {
  static constexpr double kPeriod_s = 7.0, kEnd_s = 1050.0, kSigma_hz = 0.02;
  static inline const double kSigma_rad = radians(1.0);

  static SensorState own_ship(double t) {
    static const VesselPath path({0.0, 0.0}, 4.0, radians(60.0), {{400.0, radians(-60.0), radians(0.5)}});
    return path.at(t).state;
  }
  static Eigen::Vector4d target(double t) { return {3000.0 - 3.0 * t, 7000.0, -3.0, 0.0}; }

  /// z = [bearing, frequency] without noise.
  static Eigen::Vector2d exact(double t, double f0_hz) {
    const SensorState own = own_ship(t);
    Eigen::Matrix<double, 5, 1> x;
    x << target(t), f0_hz;
    return BearingFrequency<>{own.position_m, own.velocity_mps, kSigma_rad, kSigma_hz}.h(x);
  }
  /// `noise` in standard deviations.
  static Eigen::Vector2d measured(double t, double f0_hz, double noise, RandomStream& stream) {
    const double e = stream.normal(), f = stream.normal();
    return exact(t, f0_hz) + noise * Eigen::Vector2d(kSigma_rad * e, kSigma_hz * f);
  }

  static BearingFrequencyWindows windows(std::uint64_t run, const std::function<double(double)>& f0_hz = jump(0.0),
                                         double noise = 1.0) {
    RandomStream stream({1, Role::evaluation, run}, StreamId::test);
    BearingFrequencyWindows windows;
    for (double t = 0.0; t <= kEnd_s; t += kPeriod_s) {
      const Eigen::Vector2d z = measured(t, f0_hz(t), noise, stream);
      windows.bearings.add(t, z[0], kSigma_rad, own_ship(t).position_m);
      windows.frequencies.add(t, z[1], kSigma_hz, own_ship(t));
    }
    return windows;
  }
};

}  // namespace truebearing::testing
