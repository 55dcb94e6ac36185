// SPDX-License-Identifier: Apache-2.0
// What the bearings of a window say and what they do not: Nardone and Aidala 1981 for when the range can be known at
// all. Judged by the information in free units u = (d beta, T d beta', T d(r'/r), d ln r), T the length of the window:
// a direction of u is determined where its standard deviation is under one half, of a radian or of the range.
#pragma once

#include <Eigen/Core>

namespace truebearing {

struct Observability {
  int rank = 0;  ///< of 4: how many directions the data determine
  /// Standard deviation of ln r by the data alone, all else unknown; infinite where they say nothing of it.
  double log_range_sigma = 0.0;
  /// The direction determined worst, as a change of [east, north, v_east, v_north] at the time of the estimate, of one
  /// standard deviation or of half a range, whichever is less.
  Eigen::Vector4d worst = Eigen::Vector4d::Zero();

  /// Likelihood ratio, 2 ln, against the target infinitely far away that fits best: chi-square with one degree of
  /// freedom where the bearings say nothing of the range.
  double against_infinity = 0.0;

  /// The quantile of that chi-square that is passed by chance once in 1e5.
  static constexpr double kRuledOut = 19.51;

  bool observable() const { return rank == 4 && against_infinity > kRuledOut; }
};

/// A: information about y = [beta, beta', r'/r, 1/r] (4 x 4) at y; `length_s` of the window; `T`: dx/dy at the time of
/// the estimate.
Observability observability(const Eigen::Matrix4d& A, const Eigen::Vector4d& y, double length_s,
                            const Eigen::Matrix4d& T);

}  // namespace truebearing
