// SPDX-License-Identifier: Apache-2.0
// e^x of four numbers at once, for loops of simd_dispatch.hpp.
#pragma once

#include <cstdint>

#include "truebearing/core/simd_lanes.hpp"

namespace truebearing {

/// e^x of -708 <= x <= 0: 2^n e^r, r = x - n ln 2 of at most half of it, by the rational approximation of Cephes (Moshier
/// 1989). Another x gives a number without meaning, one that is not a number gives none.
[[gnu::always_inline]] inline void exponential(Lanes& x) {
  using Bits [[gnu::vector_size(kLanes * sizeof(std::int64_t))]] = std::int64_t;
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

}  // namespace truebearing
