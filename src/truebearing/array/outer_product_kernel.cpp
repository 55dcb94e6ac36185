// SPDX-License-Identifier: Apache-2.0
#include "truebearing/array/outer_product_kernel.hpp"

#include "truebearing/core/simd_lanes.hpp"
#include "truebearing/core/simd_dispatch.hpp"

namespace truebearing::kernels {
namespace {

// In squares of lanes: those below the diagonal and on it, and their mirrors.
[[gnu::always_inline]] inline void outer_product_loops(int rows, int columns, const double* X, double scale,
                                                       double* R) {
  for (int j = 0; j < rows; j += kLanes)
    for (int i = j; i < rows; i += kLanes) {
      Lanes square[kLanes] = {}, x;
      for (int c = 0; c < columns; ++c) {
        const double* x_j = X + c * rows + j;
        load(X + c * rows + i, x);
#pragma GCC unroll 4
        for (int k = 0; k < kLanes; ++k) square[k] += x * x_j[k];
      }
#pragma GCC unroll 4
      for (int k = 0; k < kLanes; ++k) store(square[k] * scale, R + (j + k) * rows + i);
    }
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < j; ++i) R[j * rows + i] = R[i * rows + j];
}

}  // namespace

TRUEBEARING_FOR_AVX2(outer_product, (int rows, int columns, const double* X, double scale, double* R),
                     (rows, columns, X, scale, R))

}  // namespace truebearing::kernels
