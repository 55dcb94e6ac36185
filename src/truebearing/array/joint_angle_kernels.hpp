// SPDX-License-Identifier: Apache-2.0
// The small dense algebra of the joint angle filter (joint_angle_filter.hpp, whose letters these are), in SIMD
// instructions where the processor has them. Matrices are column-major without gaps.
#pragma once

namespace truebearing::kernels {

/// [L; Y'], the first 2N columns of the lower triangular root of P (3N x 3N), in place of the first 2N columns of P,
/// and L' (2N x 2N). False where their square part is not positive definite.
void prior_root(int targets, double* P, double* Lt, bool& is_positive_definite);

/// B = I + L' J L as K D^-1 K', K lower triangular with D for its diagonal and anything above it, and the step from
/// B step = L' g - u.
struct Model {
  int N;
  const double* Ut;  // [L; Y'] (3N x 2N)
  const double* Lt;  // L' (2N x 2N)
  const double *J, *g, *u;
  double *JL, *B;              // (2N x 2N): JL, and K in the place of B
  double *step, *change;       // (2N): of u, and of m
  bool* is_positive_definite;  // B
};
void solve_model(const Model& s);

/// x = x0 + U' u,  P = [0 0; 0 P_rr - Y'Y] + Z'Z; Zt: U' on entry, B: K of solve_model().
struct Posterior {
  int N;
  const double *Ut, *B, *u, *P0;
  double *Zt, *x, *P;
  bool* is_finite;  // x and P
};
void take_posterior(const Posterior& s);

}  // namespace truebearing::kernels
