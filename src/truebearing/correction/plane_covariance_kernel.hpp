// SPDX-License-Identifier: Apache-2.0
// What a correction does to the covariances of a state of the plane (4 x 4, by columns), a column at a time in SIMD
// instructions where the processor has them: to the bit what correction.cpp does to those of any size.
#pragma once

namespace truebearing::kernels {

/// P_c: the correction's own covariance, sigma_i sigma_j moments_ij in the frame, turned back from it, of the standard
/// deviations sigma of P in the frame. axis: FrameRotation::axis(). Lower halves count.
void plane_own_covariance(const double* P, const double* moments, const double* axis, double* P_c);

/// squared: d' (P_a + P_b)^-1 d, NaN where that has no value. Lower halves count.
void plane_squared_distance(const double* P_a, const double* P_b, const double* d, double& squared);

/// P: P_b + a (P_a - P_b) - (1 - a - b) P_b + a b d_i d_j, number by number, with the a and b (2 x 2) of positions
/// and velocities. The lower halves of P_a and P_b count, P is whole. definite: whether every pivot of P is more than
/// least_share of its variance, and every variance below `largest`.
void plane_blend(const double* P_a, const double* P_b, const double* d, const double* a, const double* b,
                 double least_share, double largest, double* P, bool& definite);

}  // namespace truebearing::kernels
