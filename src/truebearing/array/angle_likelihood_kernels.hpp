// SPDX-License-Identifier: Apache-2.0
// The loops of the stochastic likelihood (angle_likelihood.hpp, whose letters these are), in SIMD instructions where
// the processor has them. Matrices are column-major without gaps; `rows` is padded to whole lanes (simd_lanes.hpp).
#pragma once

namespace truebearing::kernels {

/// The Gram matrices of the columns of A and D (rows x N); N x N each.
struct Grams {
  int rows, N;
  const double *A, *D;
  double *AA, *DA, *DD;
};
void grams(const Grams& g);

/// C = (sigma^2 P^-1 + A'A)^-1 (N x N) and log det of its inverse. False where that is not positive definite.
struct Coupling {
  int N;
  double noise;
  const double *AA, *p;
  double *L, *C;  ///< N x N each, the first for what is between
  double* log_det;
  bool* is_positive_definite;
};
void coupling(const Coupling& s);

/// W = A K,  V = (D - A E) / sigma^2,  RW = R_hat W, and the inner products of the columns of W, V and A with those of
/// RW (N each).
struct Products {
  int rows, N;
  const double *A, *D, *R, *K, *E;
  double inverse_noise;
  double *W, *V, *RW;
  double *W_RW, *V_RW, *A_RW;
};
void products(const Products& p);

/// All of N x N: K = C P^-1 and E = C A'D, with which R^-1 A = A K and R^-1 D = (D - A E) / sigma^2, and of those
/// aRa = A' R^-1 A,  dRa = D' R^-1 A,  dRd = D' R^-1 D.
struct Inner {
  int N;
  double inverse_noise;
  const double *AA, *DA, *DD, *C, *p;
  double *K, *E, *aRa, *dRa, *dRd;
};
void inner(const Inner& s);

}  // namespace truebearing::kernels
