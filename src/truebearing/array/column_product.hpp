// SPDX-License-Identifier: Apache-2.0
// A column of a product of small matrices, in registers of as many lanes as the processor has. For loops of
// simd_width.hpp.
#pragma once

#include "truebearing/core/simd_width.hpp"

namespace truebearing::kernels {

/// kMaxSignals of angle_likelihood.hpp, without its headers.
inline constexpr int kMostSignals = 12;

/// out (n) = A b over the columns begin .. end - 1 of A (n rows, `stride` doubles from one column to the next). Registers
/// reach beyond the end of a column: A and out have kWidth - 1 more doubles behind them, and whoever computes the columns
/// of a matrix does it in their order, so that the next one overwrites what this one left in its place.
template <int kWidth>
[[gnu::always_inline]] inline void multiply(int n, int begin, int end, const double* A, int stride, const double* b,
                                            double* out) {
  using Vector = VectorOf<kWidth>;
  for (int i = 0; i < n; i += kWidth) {
    typename Vector::Doubles sums{}, a;
    for (int k = begin; k < end; ++k) {
      Vector::load(A + k * stride + i, a);
      sums += a * b[k];
    }
    Vector::store(sums, out + i);
  }
}

}  // namespace truebearing::kernels
