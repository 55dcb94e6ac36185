// SPDX-License-Identifier: Apache-2.0
#include "truebearing/correction/plane_covariance_kernel.hpp"

#include <cmath>

#include "truebearing/core/constants.hpp"
#include "truebearing/core/simd_dispatch.hpp"
#include "truebearing/core/simd_lanes.hpp"

namespace truebearing::kernels {
namespace {

constexpr int kN = kLanes;  // a column is one register

using Columns = Lanes[kN];

[[gnu::always_inline]] inline void load(const double* P, Columns& columns) {
  for (int j = 0; j < kN; ++j) truebearing::load(P + kN * j, columns[j]);
}

[[gnu::always_inline]] inline void plane_own_covariance_loops(const double* P, const double* moments,
                                                              const double* axis, double* P_c) {
  Lanes variance = {P[0], P[5], P[10], P[15]};
  if (axis) {
    const double x = axis[0], y = axis[1];
    const Lanes a = {P[0], P[0], P[10], P[10]}, b = {P[1], P[1], P[11], P[11]}, c = {P[5], P[5], P[15], P[15]};
    const Lanes p = {x, y, x, y}, q = {y, -x, y, -x};
    variance = p * (p * a + q * b) + q * (p * b + q * c);
  }
  const Lanes sigma = {std::sqrt(variance[0]), std::sqrt(variance[1]), std::sqrt(variance[2]), std::sqrt(variance[3])};
  Columns own;
  load(moments, own);
  own[1] = Lanes{own[0][1], own[1][1], own[1][2], own[1][3]};
  own[2] = Lanes{own[0][2], own[1][2], own[2][2], own[2][3]};
  own[3] = Lanes{own[0][3], own[1][3], own[2][3], own[3][3]};
  for (int j = 0; j < kN; ++j) own[j] *= sigma * sigma[j];
  if (axis) {
    const double x = axis[0], y = axis[1];
    const Lanes along = {x, -x, x, -x};
    for (Lanes& column : own) column = along * column + y * __builtin_shufflevector(column, column, 1, 0, 3, 2);
    for (int j = 0; j < kN; j += 2) {
      const Lanes first = own[j], second = own[j + 1];
      own[j] = x * first + y * second;
      own[j + 1] = y * first - x * second;
    }
  }
  for (int j = 0; j < kN; ++j) store(own[j], P_c + kN * j);
}

[[gnu::always_inline]] inline void plane_squared_distance_loops(const double* P_a, const double* P_b, const double* d,
                                                                double& squared) {
  Columns W, other;
  load(P_a, W);
  load(P_b, other);
  for (int j = 0; j < kN; ++j) W[j] += other[j];
  Lanes left = {d[0], d[1], d[2], d[3]};  // each as it was written: a wider load would wait for the memory
  squared = 0.0;
  for (int k = 0; k < kN; ++k) {
    const double inverse = 1.0 / (W[k][k] > 0.0 ? W[k][k] : kNaN);
    squared += left[k] * left[k] * inverse;
    const Lanes factor = W[k] * inverse;
    left -= factor * left[k];
    for (int j = k + 1; j < kN; ++j) W[j] -= factor * W[k][j];
  }
}

[[gnu::always_inline]] inline void plane_blend_loops(const double* P_a, const double* P_b, const double* d,
                                                     const double* a, const double* b, double least_share,
                                                     double largest, double* P, bool& definite) {
  Columns W, other;
  load(P_a, W);
  load(P_b, other);
  const Lanes difference = {d[0], d[1], d[2], d[3]};
  for (int j = 0; j < kN; ++j) {
    const double *aj = a + j / 2 * 2, *bj = b + j / 2 * 2;
    const Lanes A = {aj[0], aj[0], aj[1], aj[1]}, B = {bj[0], bj[0], bj[1], bj[1]};
    W[j] = other[j] + A * (W[j] - other[j]) - (1.0 - A - B) * other[j] + A * B * difference * difference[j];
    store(W[j], P + kN * j);
  }
  definite = true;
  for (int k = 0; k < kN; ++k) {
    const double variance = P[k + kN * k];
    definite &= W[k][k] > least_share * variance;
    definite &= variance < largest;
    const Lanes factor = W[k] * (1.0 / W[k][k]);
    for (int j = k + 1; j < kN; ++j) W[j] -= factor[j] * W[k];
  }
  for (int j = 1; j < kN; ++j)
    for (int i = 0; i < j; ++i) P[i + kN * j] = P[j + kN * i];
}

}  // namespace

TRUEBEARING_FOR_AVX2(plane_own_covariance, (const double* P, const double* moments, const double* axis, double* P_c),
                     (P, moments, axis, P_c))
TRUEBEARING_FOR_AVX2(plane_squared_distance, (const double* P_a, const double* P_b, const double* d, double& squared),
                     (P_a, P_b, d, squared))
TRUEBEARING_FOR_AVX2(plane_blend,
                     (const double* P_a, const double* P_b, const double* d, const double* a, const double* b,
                      double least_share, double largest, double* P, bool& definite),
                     (P_a, P_b, d, a, b, least_share, largest, P, definite))

}  // namespace truebearing::kernels
