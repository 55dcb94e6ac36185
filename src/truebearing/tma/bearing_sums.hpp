// SPDX-License-Identifier: Apache-2.0
// The sums over a window of bearings, or of frequencies, that normal equations are made of: the inner loops of
// target-motion analysis, in SIMD instructions where the processor has them. For bearing_window.cpp, modified_polar.cpp
// and doppler_term.cpp.
#pragma once

#include <cstddef>

namespace truebearing {

/// Arrays of `count` bearings: time, sine and cosine of the bearing, weight, and two coordinates of the sensor.
struct BearingArrays {
  std::size_t count;
  const double* time_s;
  const double* sine;
  const double* cosine;
  const double* weight;
  const double* first;   ///< the sensor's East; or along a line
  const double* second;  ///< its North; or across it
};

/// With J = [a, b, a t, b t] and residual r: sums of w a a, w a b, w a a t, ... and of w r a, w r b t, ...
struct CartesianSums {
  double cost, ra, rb, rat, rbt, aa, ab, bb, aat, abt, bbt, aatt, abtt, bbtt;
};
/// x = [east, north, v_east, v_north] at time origin_s.
CartesianSums cartesian_sums(const BearingArrays& bearings, const double* x, double origin_s);

/// 1/2 sum of w rho(r), J'Wr (4) and the lower triangle of J'WJ (10, row by row) in modified polar coordinates.
struct ModifiedPolarSums {
  double cost;
  double gradient[4];
  double A[10];
};
/// y = [beta, beta', r'/r, 1/r] at time origin_s; `first` and `second` are East and North of the sensor's departure
/// from its line. Residuals beyond huber_sigmas standard deviations weigh as much as one there (Huber 1964).
ModifiedPolarSums modified_polar_sums(const BearingArrays& bearings, const double* y, double origin_s,
                                      double huber_sigmas);

/// Arrays of `count` frequencies of one level: time from the origin of modified polar coordinates, frequency above some
/// mean, weight, and the departure of the sensor from its line and from the velocity of that.
struct FrequencyArrays {
  std::size_t count;
  const double* time_s;
  const double* above_hz;
  const double* weight;
  const double* east_m;
  const double* north_m;
  const double* east_mps;
  const double* north_mps;
};

/// With q = v_r / c and r = above + mean q: sums of w r^2, w (1 - q)^2, w r (1 - q), w r dq/dy (4), w (1 - q) dq/dy (4)
/// and the lower triangle of w dq/dy dq/dy' (10, row by row).
struct FrequencySums {
  double squares, information, product;
  double of_residual[4], of_shift[4], of_state[10];
};
FrequencySums frequency_sums(const FrequencyArrays& frequencies, const double* y, double mean_hz, double sound_mps);

}  // namespace truebearing
