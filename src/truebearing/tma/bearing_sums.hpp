// The sums over a window of bearings that normal equations are made of: the inner loops of target-motion analysis, in
// SIMD instructions where the processor has them. For bearing_window.cpp and modified_polar.cpp.
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

}  // namespace truebearing
