// SPDX-License-Identifier: Apache-2.0
// The arithmetic of SharedCovarianceGroup on the means of many filters side by side: component k of member i stands at
// x[k stride + i], and behind the last member, up to the stride, zero.
#pragma once

#include <cstddef>

namespace truebearing::kernels {

/// x = F x (F: n x n by columns) of `count` members.
template <int N>
void move_means(const double* F, double* x, std::size_t count, std::size_t stride);

/// nu = z - x[0, m), gained = -(nu' S^-1 nu + log |S|) / 2, x = x + K nu. Where gained is not finite it becomes minus
/// infinity, and x stays. K: n x m, by columns; S = L D L' (Ldlt), of which L is m x m, by columns, its lower part.
template <int N, int M>
void take_position(const double* z, const double* K, const double* L, const double* inverse_D, double log_determinant,
                   double* x, std::size_t count, std::size_t stride, double* gained);

/// Are all of them finite? So many that whole registers hold them (padded_to_widest(), core/simd_width.hpp).
bool all_finite(const double* values, std::size_t padded);

double sum_of(const double* values, std::size_t count);

/// mean = sum w x / sum w (n) and spread = sum w (x - mean)(x - mean)' / sum w (n x n) of the members that have a
/// weight; `weights` has the length of the stride, and sum sum_w.
template <int N>
void mix_means(const double* weights, double sum_w, const double* x, std::size_t stride, double* mean, double* spread);

}  // namespace truebearing::kernels
