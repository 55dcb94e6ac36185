// SPDX-License-Identifier: Apache-2.0
// A column of a product of small matrices, in registers of as many lanes as the processor has. For loops of
// simd_width.hpp.
#pragma once

#include <cstddef>

#include "truebearing/core/simd_width.hpp"

namespace truebearing::kernels {

/// kMaxSignals of angle_likelihood.hpp, without its headers.
inline constexpr int kMostSignals = 12;

/// Columns 0 .. kColumns - 1 of out = A B, their rows first .. n - 1, over the columns begin .. end - 1 of A. Strides:
/// of doubles, from one column to the next. Registers reach beyond the end of a column: A and out have kWidth - 1 more
/// doubles behind them, and whoever computes the columns of a matrix does it in their order, so that the next one
/// overwrites what this one left in its place.
template <int kWidth, int kColumns>
[[gnu::always_inline]] inline void multiply_columns(int first, int n, int begin, int end, const double* A, int stride,
                                                    const double* B, int B_stride, double* out, int out_stride) {
  using Vector = VectorOf<kWidth>;
  for (int i = first + (n - first - 1) / kWidth * kWidth; i >= first; i -= kWidth) {
    typename Vector::Doubles sums[std::size_t(kColumns)] = {}, a;
    for (int k = begin; k < end; ++k) {
      Vector::load(A + k * stride + i, a);
#pragma GCC unroll 8
      for (int c = 0; c < kColumns; ++c) sums[c] += a * B[c * B_stride + k];
    }
#pragma GCC unroll 8
    for (int c = 0; c < kColumns; ++c) Vector::store(sums[c], out + c * out_stride + i);
  }
}

/// out (n) = A b over the columns begin .. end - 1 of A.
template <int kWidth>
[[gnu::always_inline]] inline void multiply(int n, int begin, int end, const double* A, int stride, const double* b,
                                            double* out) {
  multiply_columns<kWidth, 1>(0, n, begin, end, A, stride, b, 0, out, 0);
}

/// The lower triangle of A B, B lower triangular (n x n), and anything above it; overwrites as multiply_columns().
template <int kWidth>
[[gnu::always_inline]] inline void multiply_lower(int n, const double* A, const double* B, int B_stride, double* out) {
  constexpr int kTogether = 4;
  const int whole = n / kTogether * kTogether;
  for (int j = 0; j < whole; j += kTogether)
    multiply_columns<kWidth, kTogether>(j / kWidth * kWidth, n, j, n, A, n, B + j * B_stride, B_stride, out + j * n, n);
  for (int j = whole; j < n; ++j)
    multiply_columns<kWidth, 1>(j / kWidth * kWidth, n, j, n, A, n, B + j * B_stride, B_stride, out + j * n, n);
}

}  // namespace truebearing::kernels
