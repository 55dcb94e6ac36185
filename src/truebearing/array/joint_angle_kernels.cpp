// SPDX-License-Identifier: Apache-2.0
#include "truebearing/array/joint_angle_kernels.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "truebearing/array/column_product.hpp"
#include "truebearing/core/simd_width.hpp"
#include "truebearing/core/with_count.hpp"

namespace truebearing::kernels {
namespace {

// N, of which the compiler shall know at least that arrays are long enough.
[[gnu::always_inline]] inline int bounded(int known, int targets) {
  return known > 0 ? known : std::min(targets, kMostSignals);
}

// Inner loops run down whole registers of a column, triangular or not: with their length known beforehand that is
// faster than half of it.

// A (rows x rows) = L D^-1 L' by its first n columns, which become those of L, D the diagonal of L: no square root
// stands between one column and the next. Two columns, of an even number, are taken from the others together. By the
// way x = L^-1 y (n); of y (n) nothing is left. False where their square part is not positive definite.
template <int kWidth>
[[gnu::always_inline]] inline bool factorise(int rows, int n, double* A, double* inverse, double* y, double* x) {
#pragma GCC unroll 8
  for (int first = 0; first < n; first += kWidth)
    for (int j = first; j < n && j < first + kWidth; j += 2) {
      const double* __restrict A_j = A + j * rows;
      double* __restrict next = A + (j + 1) * rows;
      if (!(A_j[j] > 0.0)) return false;
      inverse[j] = 1.0 / A_j[j];
      const double of_next = A_j[j + 1] * inverse[j];
#pragma omp simd
      for (int i = first; i < rows; ++i) next[i] -= A_j[i] * of_next;
      if (!(next[j + 1] > 0.0)) return false;
      inverse[j + 1] = 1.0 / next[j + 1];
      for (int k = j + 2; k < n; ++k) {
        double* __restrict A_k = A + k * rows;
        const double factor = A_j[k] * inverse[j], factor_of_next = next[k] * inverse[j + 1];
#pragma omp simd
        for (int i = first; i < rows; ++i) A_k[i] = A_k[i] - A_j[i] * factor - next[i] * factor_of_next;
      }
      if (!y) continue;
      x[j] = y[j] * inverse[j];
      x[j + 1] = (y[j + 1] - A_j[j + 1] * x[j]) * inverse[j + 1];
#pragma omp simd
      for (int i = first; i < n; ++i) y[i] = y[i] - A_j[i] * x[j] - next[i] * x[j + 1];
    }
  return true;
}

template <int kWidth>
[[gnu::always_inline]] inline void prior_root_of(int N, double* P, double* Lt, bool& is_positive_definite) {
  const int n = 2 * N, rows = 3 * N;
  double inverse[2 * kMostSignals];
  is_positive_definite = factorise<kWidth>(rows, n, P, inverse, nullptr, nullptr);
  if (!is_positive_definite) return;
  for (int j = 0; j < n; ++j) inverse[j] = std::sqrt(inverse[j]);
  for (int j = 0; j < n; ++j) {
    double* P_j = P + j * rows;
#pragma omp simd
    for (int i = 0; i < rows; ++i) P_j[i] = i < j ? 0.0 : P_j[i] * inverse[j];
    for (int i = 0; i < n; ++i) Lt[i * n + j] = P_j[i];
  }
}
template <int kWidth>
[[gnu::always_inline]] inline void prior_root_loops(int targets, double* P, double* Lt, bool& is_positive_definite) {
  with_count(
      targets, [&](auto known) __attribute__((always_inline)) {
        prior_root_of<kWidth>(bounded(known, targets), P, Lt, is_positive_definite);
      });
}

// x <- L'^-1 D x, L and D of factorise()
[[gnu::always_inline]] inline void solve_transposed(int n, const double* L, const double* inverse, double* x) {
  double rest[2 * kMostSignals] = {};
#pragma GCC unroll 24
  for (int i = n - 1; i >= 0; --i) {
    x[i] -= rest[i] * inverse[i];
    const double x_i = x[i];
#pragma GCC unroll 24
    for (int j = 0; j < i; ++j) rest[j] += L[j * n + i] * x_i;
  }
}

template <int kWidth>
[[gnu::always_inline]] inline void solve_model_of(int N, const Model& s) {
  const int n = 2 * N, rows = 3 * N;
  multiply_lower<kWidth>(n, s.J, s.Ut, rows, s.JL);
  multiply_lower<kWidth>(n, s.Lt, s.JL, n, s.B);
  double slope[std::size_t(2 * kMostSignals + kWidth)], inverse[2 * kMostSignals];
  multiply<kWidth>(n, 0, n, s.Lt, n, s.g, slope);
  for (int j = 0; j < n; ++j) {
    s.B[j * n + j] += 1.0;
    slope[j] -= s.u[j];
  }
  *s.is_positive_definite = factorise<kWidth>(n, n, s.B, inverse, slope, s.step);
  if (!*s.is_positive_definite) return;
  solve_transposed(n, s.B, inverse, s.step);
  multiply<kWidth>(n, 0, n, s.Ut, rows, s.step, s.change);
}
template <int kWidth>
[[gnu::always_inline]] inline void solve_model_loops(const Model& s) {
  with_count(
      s.N, [&](auto known) __attribute__((always_inline)) { solve_model_of<kWidth>(bounded(known, s.N), s); });
}

template <int kWidth>
[[gnu::always_inline]] inline void take_posterior_of(int N, const Posterior& s) {
  const int n = 2 * N, rows = 3 * N;
  double root[2 * kMostSignals], inverse[2 * kMostSignals];  // of D^-1, and D^-1
  for (int j = 0; j < n; ++j) inverse[j] = 1.0 / s.B[j * n + j];
  for (int j = 0; j < n; ++j) root[j] = std::sqrt(inverse[j]);
  for (int j = 0; j < n; ++j) {  // Z' = U' B_L^-T, B_L = L D^-1/2
    const double *B_j = s.B + j * n, *U_j = s.Ut + j * rows;
    double* Z_j = s.Zt + j * rows;
    const double u = s.u[j];
    for (int k = j + 1; k < n; ++k) {
      double *Z_k = s.Zt + k * rows, factor = B_j[k] * inverse[j];
#pragma omp simd
      for (int i = 0; i < rows; ++i) Z_k[i] -= Z_j[i] * factor;
    }
#pragma omp simd
    for (int i = 0; i < rows; ++i) {
      s.x[i] += U_j[i] * u;
      Z_j[i] *= root[j];
    }
  }
  // Every element as a sum in the same order, so that P is symmetric to the last bit.
  double column[std::size_t(3 * kMostSignals + kWidth)], row[2 * kMostSignals];
  for (int j = 0; j < rows; ++j) {
    double* P_j = s.P + j * rows;
    for (int k = 0; k < n; ++k) row[k] = s.Zt[k * rows + j];
    multiply<kWidth>(rows, 0, n, s.Zt, rows, row, column);
    for (int i = 0; i < rows; ++i) P_j[i] = column[i];
    if (j < n) continue;
    for (int k = 0; k < n; ++k) row[k] = s.Ut[k * rows + j];
    multiply<kWidth>(N, 0, n, s.Ut + n, rows, row, column);
    for (int i = 0; i < N; ++i) P_j[n + i] += s.P0[j * rows + n + i] - column[i];
  }
  double rest = 0.0;  // no number where one of them is not finite
#pragma omp simd reduction(+ : rest)
  for (int i = 0; i < rows; ++i) rest += 0.0 * s.x[i];
#pragma omp simd reduction(+ : rest)
  for (int i = 0; i < rows * rows; ++i) rest += 0.0 * s.P[i];
  *s.is_finite = rest == 0.0;
}
template <int kWidth>
[[gnu::always_inline]] inline void take_posterior_loops(const Posterior& s) {
  with_count(
      s.N, [&](auto known) __attribute__((always_inline)) { take_posterior_of<kWidth>(bounded(known, s.N), s); });
}

}  // namespace

TRUEBEARING_FOR_WIDEST(prior_root, (int targets, double* P, double* Lt, bool& is_positive_definite),
                       (targets, P, Lt, is_positive_definite))
TRUEBEARING_FOR_WIDEST(solve_model, (const Model& s), (s))
TRUEBEARING_FOR_WIDEST(take_posterior, (const Posterior& s), (s))

}  // namespace truebearing::kernels
