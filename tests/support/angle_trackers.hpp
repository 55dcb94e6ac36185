// SPDX-License-Identifier: Apache-2.0
// The trackers of angles as the problem's studies have them.
#pragma once

#include "truebearing/core/angle.hpp"
#include "truebearing/tracker/joint_angle_tracker.hpp"
#include "truebearing/tracker/subspace_angle_tracker.hpp"

namespace truebearing::testing {

inline constexpr double kSquareDegree = radians(1.0) * radians(1.0);

/// Ryu, Lee and Lee 2001: q = 1 deg^2/s^3, sigma 2 deg.
inline SubspaceAngleOptions paper_options(int targets = 5) {
  SubspaceAngleOptions options;
  options.targets = targets;
  options.q_rad2ps3 = kSquareDegree;
  options.sigma_rad = radians(2.0);
  return options;
}

inline JointAngleOptions joint_options(int targets = 5) {
  JointAngleOptions options;
  options.targets = targets;
  options.hypotheses.motion = {.q0 = 0.001 * kSquareDegree,
                               .q_low = 0.001 * kSquareDegree,
                               .q_high = kSquareDegree,
                               .log_power_variance_per_s = 1e-3};
  options.rate_sigma_radps = radians(2.0);
  options.noise_power = 1.0;
  return options;
}

}  // namespace truebearing::testing
