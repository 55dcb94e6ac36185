// SPDX-License-Identifier: Apache-2.0
// The arctangent of two arguments without a branch, so that a loop over bearings becomes SIMD instructions. Within
// 3e-16 rad of std::atan2 for finite arguments that are not both zero, NaN where both are.
#pragma once

#include <cmath>

#include "truebearing/core/angle.hpp"

namespace truebearing {
namespace detail {

/// x without its sign, and with that of `sign`.
[[gnu::always_inline]] inline void take_sign(double& x) {
  x = std::fabs(x);
}
[[gnu::always_inline]] inline void give_sign(const double& sign, double& x) {
  x = std::copysign(x, sign);
}
/// Of many (simd_width.hpp).
template <typename Many>
[[gnu::always_inline]] inline void take_sign(Many& x) {
  using Bits = decltype(x < x);
  x = reinterpret_cast<Many>(reinterpret_cast<const Bits&>(x) & ~reinterpret_cast<Bits>(-Many{}));
}
template <typename Many>
[[gnu::always_inline]] inline void give_sign(const Many& sign, Many& x) {
  using Bits = decltype(x < x);
  x = reinterpret_cast<Many>(reinterpret_cast<const Bits&>(x) |
                             (reinterpret_cast<const Bits&>(sign) & reinterpret_cast<Bits>(-Many{})));
}

}  // namespace detail

/// angle <- that whose sine and cosine are in the ratio sine : cosine, in [-pi, pi]. Of one, or of many at once.
template <typename Real>
[[gnu::always_inline]] inline void arctangent(const Real& sine, const Real& cosine, Real& angle) {
  constexpr double kTangentOf22_5 = 0.41421356237309503;
  // atan(x) / x as a polynomial in x^2 for |x| <= tan(pi / 8): interpolation at Chebyshev nodes, error under 6e-17.
  constexpr double kCoefficients[] = {-0x1.23b93fac21dacp-6, 0x1.3702ea64c11f2p-5,  -0x1.9c79c07a989c6p-5,
                                      0x1.def9ecd6a20f2p-5,  -0x1.10ea1d157f6ffp-4, 0x1.3b10f0f5b1224p-4,
                                      -0x1.745cf64dcc6bdp-4, 0x1.c71c70cb775cep-4,  -0x1.2492492259b3ep-3,
                                      0x1.999999999466ap-3,  -0x1.555555555552fp-2, 1.0};
  const Real zero{};
  Real y = sine, x = cosine;
  detail::take_sign(y);
  detail::take_sign(x);
  const auto steep = y > x;
  const Real high = steep ? y : x, low = steep ? x : y;
  // atan(low / high), above 22.5 degrees as 45 degrees and a rest.
  const auto turned = low > kTangentOf22_5 * high;
  const Real ratio = (turned ? low - high : low) / (turned ? low + high : high);
  const Real squared = ratio * ratio;
  Real polynomial = zero + kCoefficients[0];
#pragma GCC unroll 12
  for (int i = 1; i < 12; ++i) polynomial = polynomial * squared + kCoefficients[i];
  angle = (turned ? zero + 0.25 * kPi : zero) + ratio * polynomial;
  angle = steep ? 0.5 * kPi - angle : angle;
  angle = cosine < zero ? kPi - angle : angle;
  detail::give_sign(sine, angle);
}

[[gnu::always_inline]] inline double arctangent(double sine, double cosine) {
  double angle;
  arctangent(sine, cosine, angle);
  return angle;
}

}  // namespace truebearing
