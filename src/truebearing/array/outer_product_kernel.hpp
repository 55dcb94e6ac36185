// SPDX-License-Identifier: Apache-2.0
// The outer product of a few columns with themselves, in SIMD instructions where the processor has them.
#pragma once

namespace truebearing::kernels {

/// R = scale X X^T, of X (rows x columns) and R (rows x rows), column-major; rows padded to whole lanes
/// (simd_lanes.hpp).
void outer_product(int rows, int columns, const double* X, double scale, double* R);

}  // namespace truebearing::kernels
