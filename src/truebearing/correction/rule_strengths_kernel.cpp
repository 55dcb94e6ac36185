// SPDX-License-Identifier: Apache-2.0
#include "truebearing/correction/rule_strengths_kernel.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>

#include "truebearing/core/simd_dispatch.hpp"
#include "truebearing/core/simd_lanes.hpp"

namespace truebearing::kernels {
namespace {

using Bits [[gnu::vector_size(kLanes * sizeof(std::int64_t))]] = std::int64_t;

// exp(-700) is the smallest round power that is still a normal number: denormal strengths mean nothing and cost a
// hundred cycles each.
constexpr double kLowestExponent = -700.0;

// e^x of kLowestExponent <= x <= 0: 2^n e^r, r = x - n ln 2 of at most half of it, by the rational approximation of
// Cephes (Moshier 1989). Another x gives a number without meaning, one that is not a number gives none.
[[gnu::always_inline]] inline void exponential(Lanes& x) {
  constexpr double kInteger = 0x1.8p52;  // a sum with it has no digits behind the point
  const Lanes v = 1.4426950408889634073599 * x + 0.5;
  Lanes n = (v + kInteger) - kInteger;
  n -= n > v ? Lanes{1.0, 1.0, 1.0, 1.0} : Lanes{};
  const Lanes r = x - n * 0.693145751953125 - n * 1.42860682030941723212e-6;
  const Lanes rr = r * r;
  const Lanes p = ((1.26177193074810590878e-4 * rr + 3.02994407707441961300e-2) * rr + 1.0) * r;
  const Lanes q =
      ((3.00198505138664455042e-6 * rr + 2.52448340349684104192e-3) * rr + 2.27265548208155028766e-1) * rr + 2.0;
  const Lanes power = n + (kInteger + 1023.0);  // its last digits are the exponent of 2^n
  x = (2.0 * (p / (q - p)) + 1.0) * reinterpret_cast<Lanes>(reinterpret_cast<Bits>(power) << 52);
}

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
