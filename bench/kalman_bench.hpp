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

/// The compiler may suppose nothing of `value` from here on. benchmark::DoNotOptimize, which lets it choose between memory
/// and a register, loses a value that is to be kept (GCC bug 105519).
template <typename Value>
inline void hide(Value& value) {
  asm volatile("" : "+m"(value) : : "memory");
}

/// Positions along one axis with errors that look random and cost nothing to repeat.
inline std::array<double, kSteps> measurements(double speed_mps) {
  std::array<double, kSteps> z_m;
  for (int k = 0; k < kSteps; ++k)
    z_m[static_cast<std::size_t>(k)] = speed_mps * (k + 1) * kPeriod_s + kSigma_m * std::sin(12.9898 * (k + speed_mps));
  return z_m;
}

}  // namespace truebearing::bench
