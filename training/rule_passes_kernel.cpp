// SPDX-License-Identifier: Apache-2.0
#include "training/rule_passes_kernel.hpp"

#include <cstddef>

#include "truebearing/core/simd_dispatch.hpp"
#include "truebearing/core/simd_exponential.hpp"
#include "truebearing/core/simd_lanes.hpp"

namespace truebearing::kernels {
namespace {

// Strengths below exp(-300) mean nothing, and their products would be denormal and slow.
constexpr double kLowestExponent = -300.0;

// The exponents of kRules rules at eight rows.
template <int kRules>
[[gnu::always_inline]] inline void exponents(const double* V, const double* E, int terms, double* phi) {
  Lanes sums[std::size_t{kRules}][2] = {};
  for (int k = 0; k < terms; ++k) {
    Lanes first, second;
    load(V + k * kBlockStride, first);
    load(V + k * kBlockStride + kLanes, second);
#pragma GCC unroll 4
    for (int j = 0; j < kRules; ++j) {
      sums[j][0] += first * E[j * terms + k];
      sums[j][1] += second * E[j * terms + k];
    }
  }
#pragma GCC unroll 4
  for (int j = 0; j < kRules; ++j) {
    store(sums[j][0], phi + j * kBlockStride);
    store(sums[j][1], phi + j * kBlockStride + kLanes);
  }
}

// Of exponents, by columns, at four rows.
[[gnu::always_inline]] inline void normalise(int rules, double* phi) {
  Lanes peak, sum{};
  load(phi, peak);
  for (int j = 1; j < rules; ++j) {
    Lanes exponent;
    load(phi + j * kBlockStride, exponent);
    peak = peak < exponent ? exponent : peak;
  }
  for (int j = 0; j < rules; ++j) {
    Lanes strength;
    load(phi + j * kBlockStride, strength);
    strength -= peak;
    strength = strength < kLowestExponent ? Lanes{} + kLowestExponent : strength;
    exponential<kLanes>(strength);
    sum += strength;
    store(strength, phi + j * kBlockStride);
  }
  sum = 1.0 / sum;
  for (int j = 0; j < rules; ++j) {
    Lanes strength;
    load(phi + j * kBlockStride, strength);
    store(strength * sum, phi + j * kBlockStride);
  }
}

[[gnu::always_inline]] inline void block_strengths_loops(const StrengthsBlock& block) {
  const int rules = block.rules, terms = block.terms;
  for (int first = 0; first < block.rows; first += 2 * kLanes) {
    double* const phi = block.by_rule + first;
    int j = 0;
    for (; j + 4 <= rules; j += 4)
      exponents<4>(block.basis + first, block.coefficients + j * terms, terms, phi + j * kBlockStride);
    for (; j < rules; ++j)
      exponents<1>(block.basis + first, block.coefficients + j * terms, terms, phi + j * kBlockStride);
    normalise(rules, phi);
    normalise(rules, phi + kLanes);
  }
  for (int n = 0; n < block.rows; ++n) {
    double* const row = block.by_row + n * block.stride;
    for (int j = 0; j < rules; ++j) row[j] = block.by_rule[j * kBlockStride + n];
    for (int j = rules; j < block.stride; ++j) row[j] = 0.0;
  }
}

// A tile of 4 kHigh rows and four columns.
template <int kHigh>
[[gnu::always_inline]] inline void outer_tile(const OuterSum& sum, int i, int j) {
  Lanes sums[std::size_t{kHigh}][4] = {};
  const double* A = sum.A + i;
  const double* B = sum.B + j;
  for (int n = 0; n < sum.n; ++n, A += sum.a, B += sum.b) {
    Lanes column[std::size_t{kHigh}];
#pragma GCC unroll 2
    for (int h = 0; h < kHigh; ++h) load(A + h * kLanes, column[h]);
#pragma GCC unroll 4
    for (int c = 0; c < 4; ++c) {
#pragma GCC unroll 2
      for (int h = 0; h < kHigh; ++h) sums[h][c] += column[h] * B[c];
    }
  }
#pragma GCC unroll 4
  for (int c = 0; c < 4; ++c) {
#pragma GCC unroll 2
    for (int h = 0; h < kHigh; ++h) store(sums[h][c], sum.C + (j + c) * sum.a + i + h * kLanes);
  }
}

[[gnu::always_inline]] inline void outer_sum_loops(const OuterSum& sum) {
  for (int j = 0; j < sum.b; j += 4) {
    int i = sum.lower ? j : 0;
    for (; i + 2 * kLanes <= sum.a; i += 2 * kLanes) outer_tile<2>(sum, i, j);
    if (i < sum.a) outer_tile<1>(sum, i, j);
  }
}

// Four outputs of kRows rows.
template <int kRows>
[[gnu::always_inline]] inline void outputs_tile(const BlockOutputs& block, int n, int o) {
  Lanes sums[std::size_t{kRows}] = {};
  const double* W = block.consequents + o;
  const double* phi = block.by_row + n * block.stride;
  for (int j = 0; j < block.rules; ++j, W += block.outputs) {
    Lanes consequents;
    load(W, consequents);
#pragma GCC unroll 8
    for (int k = 0; k < kRows; ++k) sums[k] += consequents * phi[k * block.stride + j];
  }
#pragma GCC unroll 8
  for (int k = 0; k < kRows; ++k) store(sums[k], block.y + (n + k) * block.outputs + o);
}

[[gnu::always_inline]] inline void block_outputs_loops(const BlockOutputs& block) {
  for (int o = 0; o < block.outputs; o += kLanes) {
    int n = 0;
    for (; n + 8 <= block.rows; n += 8) outputs_tile<8>(block, n, o);
    for (; n < block.rows; ++n) outputs_tile<1>(block, n, o);
  }
}

[[gnu::always_inline]] inline void exponent_gradient_loops(const ExponentGradient& block) {
  for (int n = 0; n < block.rows; ++n) {
    const double* const r = block.residuals + n * block.residual_stride;
    for (int j = 0; j < block.stride; j += kLanes) {
      Lanes by_consequent{}, w, phi;
      for (int o = 0; o < block.outputs; ++o) {
        load(block.consequents + o * block.stride + j, w);
        by_consequent += w * r[o];
      }
      load(block.by_row + n * block.stride + j, phi);
      store((block.outputs_sum[n] - by_consequent) * phi, block.gradient + n * block.stride + j);
    }
  }
}

}  // namespace

TRUEBEARING_FOR_AVX2(block_strengths, (const StrengthsBlock& block), (block))
TRUEBEARING_FOR_AVX2(outer_sum, (const OuterSum& sum), (sum))
TRUEBEARING_FOR_AVX2(block_outputs, (const BlockOutputs& block), (block))
TRUEBEARING_FOR_AVX2(exponent_gradient, (const ExponentGradient& block), (block))

}  // namespace truebearing::kernels
