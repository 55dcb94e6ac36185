// SPDX-License-Identifier: Apache-2.0
#include "truebearing/array/joint_angle_kernels.hpp"

#include <cmath>

#include "truebearing/core/simd_dispatch.hpp"
#include "truebearing/core/with_count.hpp"

namespace truebearing::kernels {
namespace {

// Inner loops run down whole columns, triangular or not: with their length known beforehand that is faster than half of
// it.

// The first n columns of the lower triangular root of A (rows x rows), in place of the first n columns of A. False
// where their square part is not positive definite.
[[gnu::always_inline]] inline bool root_loops(int rows, int n, double* A) {
  for (int j = 0; j < n; ++j) {
    double* __restrict A_j = A + j * rows;
    for (int k = 0; k < j; ++k) {
      const double* A_k = A + k * rows;
      const double factor = A_k[j];
#pragma omp simd
      for (int i = 0; i < rows; ++i) A_j[i] -= A_k[i] * factor;
    }
    if (!(A_j[j] > 0.0)) return false;
    const double inverse = 1.0 / std::sqrt(A_j[j]);
#pragma omp simd
    for (int i = 0; i < rows; ++i) A_j[i] *= inverse;
  }
  return true;
}
[[gnu::always_inline]] inline void prior_root_loops(int targets, double* P, bool& is_positive_definite) {
  with_count(
      targets, [&](auto known) __attribute__((always_inline)) {
        const int N = known > 0 ? int(known) : targets;
        is_positive_definite = root_loops(3 * N, 2 * N, P);
      });
}

// x <- L^-1 x, of n columns of L that has `rows` rows
[[gnu::always_inline]] inline void solve_lower_loops(int rows, int n, const double* L, double* x) {
  for (int j = 0; j < n; ++j) {
    const double* L_j = L + j * rows;
    x[j] /= L_j[j];
    const double x_j = x[j];
#pragma omp simd
    for (int i = j + 1; i < n; ++i) x[i] -= L_j[i] * x_j;
  }
}

[[gnu::always_inline]] inline void solve_model_of(int N, const Model& s) {
  const int n = 2 * N, rows = 3 * N;
  for (int j = 0; j < n; ++j) {
    double* __restrict JL_j = s.JL + j * n, * __restrict B_j = s.B + j * n;  // so that sums stay in registers
    const double* L_j = s.Ut + j * rows;
    for (int i = 0; i < n; ++i) JL_j[i] = B_j[i] = 0.0;
    B_j[j] = 1.0;
    for (int k = j; k < n; ++k) {
      const double *J_k = s.J + k * n, factor = L_j[k];
#pragma omp simd
      for (int i = 0; i < n; ++i) JL_j[i] += J_k[i] * factor;
    }
    for (int k = j; k < n; ++k) {
      const double *Lt_k = s.Lt + k * n, factor = JL_j[k];
#pragma omp simd
      for (int i = 0; i < n; ++i) B_j[i] += Lt_k[i] * factor;
    }
    double right = -s.u[j];
    for (int k = j; k < n; ++k) right += L_j[k] * s.g[k];
    s.step[j] = right;
  }
  *s.is_positive_definite = root_loops(n, n, s.B);
  if (!*s.is_positive_definite) return;
  solve_lower_loops(n, n, s.B, s.step);
  for (int j = n - 1; j >= 0; --j) {
    const double* B_j = s.B + j * n;
    double rest = s.step[j];
    for (int i = j + 1; i < n; ++i) rest -= B_j[i] * s.step[i];
    s.step[j] = rest / B_j[j];
  }
  for (int i = 0; i < n; ++i) s.change[i] = 0.0;
  for (int j = 0; j < n; ++j) {
    const double *L_j = s.Ut + j * rows, step = s.step[j];
#pragma omp simd
    for (int i = j; i < n; ++i) s.change[i] += L_j[i] * step;
  }
}
[[gnu::always_inline]] inline void solve_model_loops(const Model& s) {
  with_count(
      s.N, [&](auto known) __attribute__((always_inline)) { solve_model_of(known > 0 ? int(known) : s.N, s); });
}

[[gnu::always_inline]] inline void take_posterior_of(int N, const Posterior& s) {
  const int n = 2 * N, rows = 3 * N;
  for (int j = 0; j < n; ++j) {  // Z' = U' B^-T
    const double *B_j = s.B + j * n, *U_j = s.Ut + j * rows;
    double* Z_j = s.Zt + j * rows;
    const double inverse = 1.0 / B_j[j], u = s.u[j];
#pragma omp simd
    for (int i = 0; i < rows; ++i) {
      s.x[i] += U_j[i] * u;
      Z_j[i] *= inverse;
    }
    for (int k = j + 1; k < n; ++k) {
      double *Z_k = s.Zt + k * rows, factor = B_j[k];
#pragma omp simd
      for (int i = 0; i < rows; ++i) Z_k[i] -= Z_j[i] * factor;
    }
  }
  for (int j = 0; j < rows; ++j) {
    double* P_j = s.P + j * rows;
    for (int i = 0; i < rows; ++i) P_j[i] = j < n || i < n ? 0.0 : s.P0[j * rows + i];
    for (int k = 0; k < n; ++k) {
      const double *Z_k = s.Zt + k * rows, *U_k = s.Ut + k * rows;
      const double z = Z_k[j], y = j < n ? 0.0 : U_k[j];
#pragma omp simd
      for (int i = 0; i < rows; ++i) P_j[i] += Z_k[i] * z - U_k[i] * y;
    }
  }
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < j; ++i) s.P[j * rows + i] = s.P[i * rows + j];
}
[[gnu::always_inline]] inline void take_posterior_loops(const Posterior& s) {
  with_count(
      s.N, [&](auto known) __attribute__((always_inline)) { take_posterior_of(known > 0 ? int(known) : s.N, s); });
}

}  // namespace

TRUEBEARING_FOR_AVX2(prior_root, (int targets, double* P, bool& is_positive_definite),
                     (targets, P, is_positive_definite))
TRUEBEARING_FOR_AVX2(solve_model, (const Model& s), (s))
TRUEBEARING_FOR_AVX2(take_posterior, (const Posterior& s), (s))

}  // namespace truebearing::kernels
