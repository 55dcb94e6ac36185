// SPDX-License-Identifier: Apache-2.0
// Angles. Inside the program every angle is in radians; bearings run clockwise from North unless a model says
// otherwise.
#pragma once

#include <cmath>
#include <numbers>

namespace truebearing {

inline constexpr double kPi = std::numbers::pi;

constexpr double radians(double angle_deg) {
  return angle_deg * (kPi / 180.0);
}
constexpr double degrees(double angle_rad) {
  return angle_rad * (180.0 / kPi);
}

/// The same direction in [-pi, pi].
inline double wrap_pi(double angle_rad) {
  return std::fabs(angle_rad) <= kPi ? angle_rad : std::remainder(angle_rad, 2.0 * kPi);
}

}  // namespace truebearing
