// SPDX-License-Identifier: Apache-2.0
// Bearings-only target-motion analysis as Cho 2015 has it: Gauss-Newton, Levenberg and Levenberg-Marquardt in Cartesian
// coordinates from 15 x 15 starts, at most ten steps, every step taken. Baselines: target_motion_batch.hpp does better.
//
// Corrected against the print: the steps are +(J'WJ)^-1 J'W(B - B_hat) (equations 9 and 10 ascend with their minus);
// the gain ratio's denominator is 1/2 h'(mu D h + J'W(B - B_hat)); equation 12's second threshold is .75; a start's
// velocity contains own ship's displacement, which equation 13 lacks.
#pragma once

#include <vector>

#include "truebearing/tma/batch_estimate.hpp"
#include "truebearing/tma/bearing_window.hpp"

namespace truebearing {

inline constexpr int kChoRanges = 15;  ///< 1 km, 2 km, ... at the first and at the last bearing
inline constexpr int kChoStarts = kChoRanges * kChoRanges;

/// Start number i of kChoStarts (equation 13, with own ship's displacement): [east, north, v_east, v_north] at the time
/// of the first bearing.
Eigen::Vector4d cho_start(const BearingWindow& window, int i);

struct ChoOptions {
  enum class Method { gauss_newton, levenberg, levenberg_marquardt };
  /// How Gauss-Newton inverts J'WJ, which the paper does not tell and which starts end in numbers depends on: by
  /// cofactors in double or single precision, or elimination with full pivoting.
  enum class Inverse { cofactor, cofactor_float, pivoted };

  Method method = Method::levenberg_marquardt;
  Inverse inverse = Inverse::cofactor;
  int k_max = 10;
  double tolerance = 1e-4;  ///< |dp|, metres and m/s together
};

/// Two or more bearings at different times.
BatchEstimate solve_cho(const BearingWindow& window, const ChoOptions& options);

}  // namespace truebearing
