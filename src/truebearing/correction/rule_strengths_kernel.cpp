// SPDX-License-Identifier: Apache-2.0
#include "truebearing/correction/rule_strengths_kernel.hpp"

#include <algorithm>
#include <limits>

#include "truebearing/core/simd_dispatch.hpp"
#include "truebearing/core/simd_exponential.hpp"
#include "truebearing/core/simd_lanes.hpp"

namespace truebearing::kernels {
namespace {

// exp(-700) is the smallest round power that is still a normal number: denormal strengths mean nothing and cost a
// hundred cycles each.
constexpr double kLowestExponent = -700.0;

[[gnu::always_inline]] inline void rule_strengths_loops(const RuleBlocks& rules, const double* u, double* phi) {
  const double *c = rules.centres, *w = rules.inverse_widths;
  Lanes largest = Lanes{} - std::numeric_limits<double>::infinity();
  for (int b = 0; b < rules.blocks; ++b) {
    Lanes exponent{};
    for (int i = 0; i < rules.inputs; ++i, c += kLanes, w += kLanes) {
      Lanes centre, inverse_width;
      load(c, centre);
      load(w, inverse_width);
      const Lanes distance = u[i] * inverse_width - centre;
      exponent -= distance * distance;
    }
    largest = largest > exponent ? largest : exponent;
    store(exponent, phi + b * kLanes);
  }
  double highest = largest[0];
  for (int k = 1; k < kLanes; ++k) highest = std::max<double>(highest, largest[k]);
  Lanes total{};
  for (int b = 0; b < rules.blocks; ++b) {
    Lanes strength;
    load(phi + b * kLanes, strength);
    strength -= highest;
    strength = kLowestExponent > strength ? Lanes{} + kLowestExponent : strength;
    exponential(strength);
    total += strength;
    store(strength, phi + b * kLanes);
  }
  const double all = sum(total);
  for (int b = 0; b < rules.blocks; ++b) {
    Lanes strength;
    load(phi + b * kLanes, strength);
    store(strength / all, phi + b * kLanes);
  }
}

}  // namespace

TRUEBEARING_FOR_AVX2(rule_strengths, (const RuleBlocks& rules, const double* u, double* phi), (rules, u, phi))

}  // namespace truebearing::kernels
