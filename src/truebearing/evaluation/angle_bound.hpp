// SPDX-License-Identifier: Apache-2.0
// What trackers of several targets at a line array cannot fall below, run by run, from the truth and how loud the
// targets are:
//   Cramer-Rao  of an interval by itself, powers unknown. It has no end as two targets meet.
//   posterior   of all intervals so far, targets whose angular acceleration is white noise of density q, their powers
//               known, x = [theta_1, rate_1, theta_2, ...]; Tichavsky, Muravchik and Nehorai 1998. It is that of the
//               random model, along the true course: a tracker that knows more of a certain course may go below.
// The noise power is known, and targets stand still inside an interval.
#pragma once

#include <cstddef>
#include <vector>

#include "truebearing/core/angle.hpp"
#include "truebearing/recording/recording.hpp"

namespace truebearing {

/// [place]: target * steps + step. NaN where the step is not scored or the truth of the target not known.
struct AngleVariances {
  std::size_t targets = 0;
  std::vector<double> cramer_rao_deg2;    ///< NaN too where nothing usable was heard
  std::vector<bool> apart;                ///< from every other target
  std::vector<double> posterior_deg2;     ///< of the angle
  std::vector<double> posterior_deg2ps2;  ///< of its rate

  std::size_t steps() const { return targets > 0 ? posterior_deg2.size() / targets : 0; }
};

struct AngleBound {
  double q_rad2ps3 = 0.03 * radians(1.0) * radians(1.0);
  double rate_sigma_radps = radians(2.0);  ///< of what is known of a target's rate when it is first heard: it is 0
  double apart_rad = radians(10.0);        ///< farther than this from every other target it is apart

  /// from_step: number of the first scored measurement, counted from 1; the bound itself begins with the first. Throws
  /// InputError where the recording has no snapshots, or no truth of angles and powers.
  AngleVariances variances(const Recording& recording, int from_step) const;
};

}  // namespace truebearing
