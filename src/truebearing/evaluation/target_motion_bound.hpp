// SPDX-License-Identifier: Apache-2.0
// The Cramer-Rao bound on a target's position, velocity, range, course and speed, run by run, from the truth and where
// own ship was: bearings of a target at constant velocity, or one whose acceleration is white noise. Where frequencies
// are measured with them, the unknowns are the state [east, north, v_east, v_north] and one frequency for each that the
// source has in truth: when it jumps, and back to which it does, is taken as known. With a prior it is the posterior
// bound. Or of range and bearing, with a range rate or without. Van Trees 1968; Tichavsky, Muravchik and Nehorai 1998.
#pragma once

#include <optional>
#include <vector>

#include "truebearing/evaluation/target_motion.hpp"
#include "truebearing/measurement/bearing_frequency.hpp"
#include "truebearing/recording/recording.hpp"
#include "truebearing/tma/range_prior.hpp"

namespace truebearing {

struct TargetMotionBound {
  /// What is believed at the first bearing; its covariance is taken at the true range, bearing and speed.
  std::optional<RangePrior> prior;
  double q_m2ps3 = 0.0;                      ///< spectral density of the acceleration; 0 for a constant velocity
  std::optional<double> bearing_sigma_rad;   ///< where measurements do not carry their own
  bool frequencies = true;                   ///< are they used, where they are measured?
  std::optional<double> frequency_sigma_hz;  ///< where measurements do not carry their own
  double sound_mps = kSoundInWater_mps;      ///< speed of sound
  std::optional<double> range_sigma_m, range_rate_sigma_mps;  ///< where measurements do not carry their own
  double range_rate_correlation = 0.0;                        ///< of range and range rate
  bool range_rates = true;                                    ///< are they used, where they are measured?

  /// The variances at each of `steps` of the recording: NaN where the state is not determined yet, where q is 0 and the
  /// truth has changed its velocity by then (a bound that held for it would need to know how), or where the step is
  /// negative. Throws InputError where the recording holds no bearings from an own ship and no range with its bearing, or
  /// no truth in the plane, or none of the frequency that is used. A radar stands at the origin where it does not say.
  std::vector<TargetMotionVariance> variances(const Recording& recording, const std::vector<int>& steps) const;

 private:
  std::vector<TargetMotionVariance> variances_of_radar(const Recording& recording, const std::vector<int>& steps) const;
};

}  // namespace truebearing
