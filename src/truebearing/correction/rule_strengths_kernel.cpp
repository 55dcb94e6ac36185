// SPDX-License-Identifier: Apache-2.0
#include "truebearing/correction/rule_strengths_kernel.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>

#include "truebearing/core/simd_exponential.hpp"
#include "truebearing/core/simd_lanes.hpp"
#include "truebearing/core/simd_width.hpp"

namespace truebearing::kernels {
namespace {

// exp(-700) is the smallest round power that is still a normal number: denormal strengths mean nothing and cost a
// hundred cycles each.
constexpr double kLowestExponent = -700.0;

// A block of rules in as many registers as it takes. What is taken over its lanes is taken in one order, whatever the
// width.
template <int kWidth>
struct Block {
  using Vector = VectorOf<kWidth>;
  using Doubles = typename Vector::Doubles;
  static constexpr std::size_t kParts = static_cast<std::size_t>(kRuleBlock / kWidth);

  Doubles part[kParts];

  [[gnu::always_inline]] void fill(double value) {
    for (Doubles& p : part) p = Doubles{} + value;
  }
  [[gnu::always_inline]] void load(const double* from) {
    for (std::size_t k = 0; k < kParts; ++k, from += kWidth) Vector::load(from, part[k]);
  }
  [[gnu::always_inline]] void store(double* to) const {
    for (std::size_t k = 0; k < kParts; ++k, to += kWidth) Vector::store(part[k], to);
  }
  // Its halves.
  [[gnu::always_inline]] void split(VectorOf<4>::Doubles& low, VectorOf<4>::Doubles& high) const {
    if constexpr (kWidth == kRuleBlock) {
      low = __builtin_shufflevector(part[0], part[0], 0, 1, 2, 3);
      high = __builtin_shufflevector(part[0], part[0], 4, 5, 6, 7);
    } else {
      low = part[0];
      high = part[1];
    }
  }
  [[gnu::always_inline]] double sum() const {
    VectorOf<4>::Doubles low, high;
    split(low, high);
    low += high;
    return truebearing::sum(low);
  }
  [[gnu::always_inline]] double largest() const {
    VectorOf<4>::Doubles low, high;
    split(low, high);
    low = low > high ? low : high;
    return std::max(std::max(low[0], low[2]), std::max(low[1], low[3]));
  }
};

// The exponents of kBlocks blocks from block b on, side by side; their largest goes into `largest`.
template <int kWidth, std::size_t kBlocks>
[[gnu::always_inline]] inline void exponents(const RuleBlocks& rules, int b, const double* u, double* phi,
                                             Block<kWidth>& largest) {
  const std::ptrdiff_t stride = kRuleBlock * rules.inputs;
  const double *c = rules.centres + b * stride, *w = rules.inverse_widths + b * stride;
  Block<kWidth> exponent[kBlocks];
  for (auto& one : exponent) one.fill(0.0);
  for (int i = 0; i < rules.inputs; ++i, c += kRuleBlock, w += kRuleBlock)
    for (std::size_t k = 0; k < kBlocks; ++k) {
      Block<kWidth> centre, inverse_width;
      centre.load(c + static_cast<std::ptrdiff_t>(k) * stride);
      inverse_width.load(w + static_cast<std::ptrdiff_t>(k) * stride);
      for (std::size_t p = 0; p < Block<kWidth>::kParts; ++p) {
        const auto distance = u[i] * inverse_width.part[p] - centre.part[p];
        exponent[k].part[p] -= distance * distance;
      }
    }
  for (std::size_t k = 0; k < kBlocks; ++k) {
    for (std::size_t p = 0; p < Block<kWidth>::kParts; ++p)
      largest.part[p] = largest.part[p] > exponent[k].part[p] ? largest.part[p] : exponent[k].part[p];
    exponent[k].store(phi + (b + static_cast<int>(k)) * kRuleBlock);
  }
}

// phi times a number, which is returned: the sum of them all. The largest of them is 1.
template <int kWidth>
[[gnu::always_inline]] inline double unscaled_strengths(const RuleBlocks& rules, const double* u, double* phi) {
  Block<kWidth> largest, total;
  largest.fill(-std::numeric_limits<double>::infinity());
  int b = 0;
  for (; b + 4 <= rules.blocks; b += 4) exponents<kWidth, 4>(rules, b, u, phi, largest);
  for (; b < rules.blocks; ++b) exponents<kWidth, 1>(rules, b, u, phi, largest);
  const double highest = largest.largest();
  total.fill(0.0);
  for (b = 0; b < rules.blocks; ++b) {
    Block<kWidth> strength;
    strength.load(phi + b * kRuleBlock);
    for (std::size_t p = 0; p < Block<kWidth>::kParts; ++p) {
      auto& part = strength.part[p];
      part -= highest;
      part = kLowestExponent > part ? typename Block<kWidth>::Doubles{} + kLowestExponent : part;
      exponential<kWidth>(part);
      total.part[p] += part;
    }
    strength.store(phi + b * kRuleBlock);
  }
  return total.sum();
}

// scale times the products of phi (rules) with four columns at a time, of which `columns` count.
template <int kWidth>
[[gnu::always_inline]] inline void means_of(int rules, int columns, const double* phi, const double* table,
                                            double scale, double* mean) {
  constexpr int kTogether = 4;
  using Four = VectorOf<kTogether>::Doubles;
  for (int c = 0; c < columns; c += kTogether) {
    const double* column[kTogether];
    for (int k = 0; k < kTogether; ++k) column[k] = table + std::min(c + k, columns - 1) * rules;
    Block<kWidth> total[kTogether], strength, said;
    for (auto& one : total) one.fill(0.0);
    int j = 0;
    for (; j + kRuleBlock <= rules; j += kRuleBlock) {
      strength.load(phi + j);
      for (int k = 0; k < kTogether; ++k) {
        said.load(column[k] + j);
        for (std::size_t p = 0; p < Block<kWidth>::kParts; ++p) total[k].part[p] += strength.part[p] * said.part[p];
      }
    }
    // The four sums side by side.
    Four sums[kTogether];
    for (int k = 0; k < kTogether; ++k) {
      Four high;
      total[k].split(sums[k], high);
      sums[k] += high;
    }
    const Four ab =
        __builtin_shufflevector(sums[0], sums[1], 0, 4, 2, 6) + __builtin_shufflevector(sums[0], sums[1], 1, 5, 3, 7);
    const Four cd =
        __builtin_shufflevector(sums[2], sums[3], 0, 4, 2, 6) + __builtin_shufflevector(sums[2], sums[3], 1, 5, 3, 7);
    Four all = __builtin_shufflevector(ab, cd, 0, 1, 4, 5) + __builtin_shufflevector(ab, cd, 2, 3, 6, 7);
    for (; j < rules; ++j) all += phi[j] * Four{column[0][j], column[1][j], column[2][j], column[3][j]};
    all *= scale;
    if (c + kTogether <= columns)
      VectorOf<kTogether>::store(all, mean + c);
    else
      for (int k = 0; c + k < columns; ++k) mean[c + k] = all[k];
  }
}

template <int kWidth>
[[gnu::always_inline]] inline void means(const RuleTables& said, const double* phi, double scale, double* numbers,
                                         double* matrix) {
  means_of<kWidth>(said.rules, said.columns, phi, said.numbers, scale, numbers);
  means_of<kWidth>(said.rules, said.n * said.n, phi, said.matrices, scale, matrix);
}

template <int kWidth>
[[gnu::always_inline]] inline void rule_strengths_loops(const RuleBlocks& rules, const double* u, double* phi) {
  const double scale = 1.0 / unscaled_strengths<kWidth>(rules, u, phi);
  for (int j = 0; j < rules.blocks * kRuleBlock; j += kRuleBlock) {
    Block<kWidth> strength;
    strength.load(phi + j);
    for (auto& part : strength.part) part *= scale;
    strength.store(phi + j);
  }
}

template <int kWidth>
[[gnu::always_inline]] inline void rule_means_loops(const RuleTables& said, const double* phi, double* numbers,
                                                    double* matrix) {
  means<kWidth>(said, phi, 1.0, numbers, matrix);
}

template <int kWidth>
[[gnu::always_inline]] inline void rule_answer_loops(const RuleBlocks& rules, const RuleTables& said, const double* u,
                                                     double* numbers, double* matrix) {
  alignas(64) double phi[kMostRules];
  const double total = unscaled_strengths<kWidth>(rules, u, phi);
  means<kWidth>(said, phi, 1.0 / total, numbers, matrix);
}

}  // namespace

TRUEBEARING_FOR_WIDEST(rule_strengths, (const RuleBlocks& rules, const double* u, double* phi), (rules, u, phi))
TRUEBEARING_FOR_WIDEST(rule_means, (const RuleTables& said, const double* phi, double* numbers, double* matrix),
                       (said, phi, numbers, matrix))
TRUEBEARING_FOR_WIDEST(rule_answer,
                       (const RuleBlocks& rules, const RuleTables& said, const double* u, double* numbers,
                        double* matrix),
                       (rules, said, u, numbers, matrix))

}  // namespace truebearing::kernels
