// SPDX-License-Identifier: Apache-2.0
#include "truebearing/array/joint_angle_kernels.hpp"

#include <cmath>

#include "truebearing/array/column_product.hpp"
#include "truebearing/core/simd_width.hpp"
#include "truebearing/core/with_count.hpp"

namespace truebearing::kernels {
namespace {

// Inner loops run down whole columns, triangular or not: with their length known beforehand that is faster than half of
// it.

// The first n columns of the lower triangular root of A (rows x rows), in place of the first n columns of A: as L D L'
// first, so that no square root stands between one column and the next. False where their square part is not positive
// definite.
[[gnu::always_inline]] inline bool root_loops(int rows, int n, double* A) {
  for (int j = 0; j < n; ++j) {
    const double* __restrict A_j = A + j * rows;
    if (!(A_j[j] > 0.0)) return false;
    const double inverse = 1.0 / A_j[j];
    for (int k = j + 1; k < n; ++k) {
      double* __restrict A_k = A + k * rows;
      const double factor = A_j[k] * inverse;
#pragma omp simd
      for (int i = 0; i < rows; ++i) A_k[i] -= A_j[i] * factor;
    }
  }
  for (int j = 0; j < n; ++j) {
    double* A_j = A + j * rows;
    const double inverse = 1.0 / std::sqrt(A_j[j]);
#pragma omp simd
    for (int i = 0; i < rows; ++i) A_j[i] *= inverse;
  }
  return true;
}

template <int kWidth>
[[gnu::always_inline]] inline void prior_root_loops(int targets, double* P, bool& is_positive_definite) {
  with_count(
      targets, [&](auto known) __attribute__((always_inline)) {
        const int N = known > 0 ? int(known) : targets;
        is_positive_definite = root_loops(3 * N, 2 * N, P);
      });
}

// x <- L'^-1 L^-1 x, L lower triangular (n x n)
[[gnu::always_inline]] inline void solve_root_loops(int n, const double* L, double* x) {
  double inverse[2 * kMostSignals];  // of the diagonal, all before the first is waited for
  for (int j = 0; j < n; ++j) inverse[j] = 1.0 / L[j * n + j];
  for (int j = 0; j < n; ++j) {
    const double* L_j = L + j * n;
    x[j] *= inverse[j];
    const double x_j = x[j];
#pragma omp simd
    for (int i = j + 1; i < n; ++i) x[i] -= L_j[i] * x_j;
  }
  for (int j = n - 1; j >= 0; --j) {
    const double* L_j = L + j * n;
    double rest = x[j];
    for (int i = j + 1; i < n; ++i) rest -= L_j[i] * x[i];
    x[j] = rest * inverse[j];
  }
}

template <int kWidth>
[[gnu::always_inline]] inline void solve_model_of(int N, const Model& s) {
  const int n = 2 * N, rows = 3 * N;
  for (int j = 0; j < n; ++j) {
    multiply<kWidth>(n, j, n, s.J, n, s.Ut + j * rows, s.JL + j * n);
    multiply<kWidth>(n, j, n, s.Lt, n, s.JL + j * n, s.B + j * n);
  }
  multiply<kWidth>(n, 0, n, s.Lt, n, s.g, s.step);
  for (int j = 0; j < n; ++j) {
    s.B[j * n + j] += 1.0;
    s.step[j] -= s.u[j];
  }
  *s.is_positive_definite = root_loops(n, n, s.B);
  if (!*s.is_positive_definite) return;
  solve_root_loops(n, s.B, s.step);
  multiply<kWidth>(n, 0, n, s.Ut, rows, s.step, s.change);
}
template <int kWidth>
[[gnu::always_inline]] inline void solve_model_loops(const Model& s) {
  with_count(
      s.N, [&](auto known) __attribute__((always_inline)) { solve_model_of<kWidth>(known > 0 ? int(known) : s.N, s); });
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
template <int kWidth>
[[gnu::always_inline]] inline void take_posterior_loops(const Posterior& s) {
  with_count(
      s.N, [&](auto known) __attribute__((always_inline)) { take_posterior_of(known > 0 ? int(known) : s.N, s); });
}

}  // namespace

TRUEBEARING_FOR_WIDEST(prior_root, (int targets, double* P, bool& is_positive_definite),
                       (targets, P, is_positive_definite))
TRUEBEARING_FOR_WIDEST(solve_model, (const Model& s), (s))
TRUEBEARING_FOR_WIDEST(take_posterior, (const Posterior& s), (s))

}  // namespace truebearing::kernels
