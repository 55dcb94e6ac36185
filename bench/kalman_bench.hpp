// SPDX-License-Identifier: Apache-2.0
// The problem that all Kalman filter benchmarks share: one stream of measurements of a target at constant velocity, the
// step of 1 s, process and measurement noise. Times are per predict + update.
#pragma once

#include <array>
#include <cmath>

namespace truebearing::bench {

inline constexpr int kSteps = 512;
inline constexpr double kPeriod_s = 1.0;
inline constexpr double kDensity_m2ps3 = 0.1;
inline constexpr double kSigma_m = 10.0;
inline constexpr double kP0 = 1000.0;  ///< of every component

/// Positions along one axis with errors that look random and cost nothing to repeat.
inline std::array<double, kSteps> measurements(double speed_mps) {
  std::array<double, kSteps> z_m;
  for (int k = 0; k < kSteps; ++k)
    z_m[static_cast<std::size_t>(k)] = speed_mps * (k + 1) * kPeriod_s + kSigma_m * std::sin(12.9898 * (k + speed_mps));
  return z_m;
}

}  // namespace truebearing::bench
