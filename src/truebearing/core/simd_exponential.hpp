// SPDX-License-Identifier: Apache-2.0
// e^x of several numbers at once, for loops of simd_dispatch.hpp and simd_width.hpp.
#pragma once

#include "truebearing/core/simd_width.hpp"

namespace truebearing {

/// e^x of -708 <= x <= 0 to two units in the last place: 2^n e^r with r = x - n ln 2 of at most half of it, by Taylor's
/// polynomial, whose rest is below 1e-17, and whose terms are summed in pairs, for none to wait. Another x gives a number
/// without meaning, one that is not a number gives none.
template <int kCount>
[[gnu::always_inline]] inline void exponential(typename VectorOf<kCount>::Doubles& x) {
  using Doubles = typename VectorOf<kCount>::Doubles;
  using Bits = typename VectorOf<kCount>::Bits;
  constexpr double kInteger = 0x1.8p52;  // a sum with it has no digits behind the point
  const Doubles n = (1.4426950408889634073599 * x + kInteger) - kInteger;
  const Doubles r = x - n * 0.693145751953125 - n * 1.42860682030941723212e-6;
  const Doubles r2 = r * r, r4 = r2 * r2, r8 = r4 * r4;
  const Doubles e01 = 1.0 + r, e23 = 1.0 / 2.0 + r * (1.0 / 6.0);
  const Doubles e45 = 1.0 / 24.0 + r * (1.0 / 120.0), e67 = 1.0 / 720.0 + r * (1.0 / 5040.0);
  const Doubles e89 = 1.0 / 40320.0 + r * (1.0 / 362880.0), eab = 1.0 / 3628800.0 + r * (1.0 / 39916800.0);
  const Doubles ecd = 1.0 / 479001600.0 + r * (1.0 / 6227020800.0);
  const Doubles e = ((e01 + r2 * e23) + r4 * (e45 + r2 * e67)) + r8 * ((e89 + r2 * eab) + r4 * ecd);
  const Doubles power = n + (kInteger + 1023.0);  // its last digits are the exponent of 2^n
  x = e * reinterpret_cast<Doubles>(reinterpret_cast<Bits>(power) << 52);
}

}  // namespace truebearing
