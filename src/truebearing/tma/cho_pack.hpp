// SPDX-License-Identifier: Apache-2.0
// The inner loops of cho_2015.hpp for eight starts at once, one in every lane of SIMD instructions where the processor
// has them: each lane adds up its bearings in their order, so that no start depends on its neighbours. Rows of kPack
// doubles, one per start.
#pragma once

#include "truebearing/tma/bearing_sums.hpp"

namespace truebearing {

inline constexpr int kPack = 8;

/// Rows of what normal equations are made of, with J = [a, b, a t, b t] (bearing_sums.hpp).
enum CartesianRow : int { kCost, kRa, kRb, kRat, kRbt, kAA, kAB, kBB, kAAt, kABt, kBBt, kAAtt, kABtt, kBBtt };
inline constexpr int kCartesianRows = kBBtt + 1;
/// The rows of the entries of J'WJ.
inline constexpr int kNormalMatrix[4][4] = {
    {kAA, kAB, kAAt, kABt}, {kAB, kBB, kABt, kBBt}, {kAAt, kABt, kAAtt, kABtt}, {kABt, kBBt, kABtt, kBBtt}};

struct ChoPack {
  double x[4][kPack];                  ///< [east, north, v_east, v_north] at the origin
  double sums[kCartesianRows][kPack];  ///< of normal equations, at x
  double mu[kPack];                    ///< the damping
  double h[4][kPack];                  ///< the step
  double promised[kPack];              ///< L(0) - L(h) of the gain ratio
};

/// pack.sums at pack.x, times from origin_s.
void sum_pack(const BearingArrays& bearings, double origin_s, ChoPack& pack);

/// pack.h and pack.promised: (J'WJ + mu D) h = J'Wr, with D = diag(J'WJ) (Marquardt), or I (Levenberg).
void damped_steps(bool marquardt, ChoPack& pack);

}  // namespace truebearing
