// SPDX-License-Identifier: Apache-2.0
// Sines and cosines of several numbers at once, for loops of simd_width.hpp.
#pragma once

#include "truebearing/core/simd_width.hpp"

namespace truebearing {

/// sin x and cos x of |x| < 1e8 to 2e-16, by the polynomials of Cephes (Moshier 1989) in what is left of x next to the
/// nearest multiple of pi/2. A larger x gives numbers without meaning, one that is not finite gives none.
template <int kWidth>
[[gnu::always_inline]] inline void sine_and_cosine(const typename VectorOf<kWidth>::Doubles& x,
                                                   typename VectorOf<kWidth>::Doubles& sine,
                                                   typename VectorOf<kWidth>::Doubles& cosine) {
  using Doubles = typename VectorOf<kWidth>::Doubles;
  using Bits = typename VectorOf<kWidth>::Bits;
  constexpr double kInteger = 0x1.8p52;  // a sum with it has no digits behind the point
  const Doubles turns = x * 0.63661977236758134308 + kInteger;
  const Doubles n = turns - kInteger;
  const Bits quadrant = reinterpret_cast<Bits>(turns);  // its last digits
  // pi/2 in three parts, the first two so short that their multiples are exact.
  const Doubles r = x - n * 1.57079625129699707031 - n * 7.54978941586159635335e-8 - n * 5.39030285815811905290e-15;
  const Doubles z = r * r;
  const Doubles s =
      ((((1.58962301576546568060e-10 * z - 2.50507477628578072866e-8) * z + 2.75573136213857245213e-6) * z -
        1.98412698295895385996e-4) *
           z +
       8.33333333332211858878e-3) *
          z -
      1.66666666666666307295e-1;
  const Doubles c =
      ((((2.08757008419747316778e-9 - 1.13585365213876817300e-11 * z) * z - 2.75573141792967388112e-7) * z +
        2.48015872888517045348e-5) *
           z -
       1.38888888888730564116e-3) *
          z +
      4.16666666666665929218e-2;
  const Doubles sine_r = r + r * z * s, cosine_r = 1.0 - 0.5 * z + z * z * c;
  const auto is_odd = (quadrant & 1) != 0;
  const Bits sine_sign = (quadrant & 2) << 62, cosine_sign = ((quadrant + 1) & 2) << 62;
  sine = reinterpret_cast<Doubles>(reinterpret_cast<Bits>(is_odd ? cosine_r : sine_r) ^ sine_sign);
  cosine = reinterpret_cast<Doubles>(reinterpret_cast<Bits>(is_odd ? sine_r : cosine_r) ^ cosine_sign);
}

}  // namespace truebearing
