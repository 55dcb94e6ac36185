// SPDX-License-Identifier: Apache-2.0
// The natural logarithm of several numbers at once, for loops of simd_dispatch.hpp and simd_width.hpp.
#pragma once

#include <cstdint>

#include "truebearing/core/simd_width.hpp"

namespace truebearing {

/// log x of positive normal numbers: x = 2^k m, m about 1, log m by the minimax polynomial of fdlibm (Sun Microsystems
/// 1993), whose error is below one unit in the last place. Another x gives a number without meaning.
template <int kCount>
[[gnu::always_inline]] inline void logarithm(typename VectorOf<kCount>::Doubles& x) {
  using Doubles = typename VectorOf<kCount>::Doubles;
  using Bits [[gnu::vector_size(kCount * sizeof(std::uint64_t))]] = std::uint64_t;  // of any x: they may run over
  constexpr double kInteger = 0x1p52;  // the last digits of a sum with it are an integer
  constexpr std::uint64_t kOne = 0x3ff0000000000000, kRootOfHalf = 0x3fe6a09e667f3bcd, kDigits = 0x000fffffffffffff;
  const Bits bits = reinterpret_cast<Bits>(x) + (kOne - kRootOfHalf);  // m in [2^-1/2, 2^1/2)
  const Doubles m = reinterpret_cast<Doubles>((bits & kDigits) + kRootOfHalf);
  const Bits exponent = (bits >> 52) | reinterpret_cast<Bits>(Doubles{} + kInteger);
  const Doubles k = reinterpret_cast<Doubles>(exponent) - (kInteger + 1023.0);
  const Doubles f = m - 1.0, s = f / (2.0 + f), z = s * s, half = 0.5 * f * f;
  const Doubles r =
      z *
      (6.666666666666735130e-1 +
       z * (3.999999999940941908e-1 +
            z * (2.857142874366239149e-1 +
                 z * (2.222219843214978396e-1 +
                      z * (1.818357216161805012e-1 + z * (1.531383769920937332e-1 + z * 1.479819860511658591e-1))))));
  x = k * 6.93147180369123816490e-1 - ((half - (s * (half + r) + k * 1.90821492927058770002e-10)) - f);
}

}  // namespace truebearing
