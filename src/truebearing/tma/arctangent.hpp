// SPDX-License-Identifier: Apache-2.0
// The arctangent of two arguments without a branch, so that a loop over bearings becomes SIMD instructions. Within
// 3e-16 rad of std::atan2 for finite arguments that are not both zero, NaN where both are.
#pragma once

#include <cmath>
#include <numbers>

namespace truebearing {

/// The angle whose sine and cosine are in the ratio sine : cosine, in [-pi, pi].
[[gnu::always_inline]] inline double arctangent(double sine, double cosine) {
  constexpr double kTangentOf22_5 = 0.41421356237309503;
  constexpr double kPi = std::numbers::pi;
  // atan(x) / x as a polynomial in x^2 for |x| <= tan(pi / 8): interpolation at Chebyshev nodes, error under 6e-17.
  constexpr double kCoefficients[] = {-0x1.23b93fac21dacp-6, 0x1.3702ea64c11f2p-5,  -0x1.9c79c07a989c6p-5,
                                      0x1.def9ecd6a20f2p-5,  -0x1.10ea1d157f6ffp-4, 0x1.3b10f0f5b1224p-4,
                                      -0x1.745cf64dcc6bdp-4, 0x1.c71c70cb775cep-4,  -0x1.2492492259b3ep-3,
                                      0x1.999999999466ap-3,  -0x1.555555555552fp-2, 1.0};
  const double y = std::fabs(sine), x = std::fabs(cosine);
  const bool steep = y > x;
  const double high = steep ? y : x, low = steep ? x : y;
  // atan(low / high), above 22.5 degrees as 45 degrees and a rest.
  const bool turned = low > kTangentOf22_5 * high;
  const double ratio = (turned ? low - high : low) / (turned ? low + high : high);
  const double squared = ratio * ratio;
  double polynomial = kCoefficients[0];
  for (int i = 1; i < 12; ++i) polynomial = polynomial * squared + kCoefficients[i];
  double angle = (turned ? 0.25 * kPi : 0.0) + ratio * polynomial;
  angle = steep ? 0.5 * kPi - angle : angle;
  angle = cosine < 0.0 ? kPi - angle : angle;
  return std::copysign(angle, sine);
}

}  // namespace truebearing
