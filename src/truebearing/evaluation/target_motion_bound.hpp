// The Cramer-Rao bound on a target's position, velocity, range, course and speed, run by run, from the truth and where
// own ship was: bearings of a target at constant velocity, or one whose acceleration is white noise. With a prior it is
// the posterior bound. Van Trees 1968; Tichavsky, Muravchik and Nehorai 1998.
#pragma once

#include <optional>
#include <vector>

#include "truebearing/evaluation/target_motion.hpp"
#include "truebearing/measurement/recording.hpp"
#include "truebearing/tma/range_prior.hpp"

namespace truebearing {

struct TargetMotionBound {
  /// What is believed at the first bearing; its covariance is taken at the true range, bearing and speed.
  std::optional<RangePrior> prior;
  double q_m2ps3 = 0.0;                     ///< spectral density of the acceleration; 0 for a constant velocity
  std::optional<double> bearing_sigma_rad;  ///< where measurements do not carry their own

  /// The variances at each of `steps` of the recording: NaN where the state is not determined yet, or the step is
  /// negative. Throws InputError where the recording holds no bearings from an own ship, or no truth in the plane, or a
  /// truth that changes its velocity though q is 0.
  std::vector<TargetMotionVariance> variances(const Recording& recording, const std::vector<int>& steps) const;
};

}  // namespace truebearing
