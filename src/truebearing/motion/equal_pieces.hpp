// SPDX-License-Identifier: Apache-2.0
// An interval cut into equal pieces of at most a given length, by which a motion that is good for a while crosses it.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace truebearing {

template <typename Scalar>
struct EqualPieces {
  int count;
  Scalar length_s;  ///< NaN of more than kMost pieces: after as long, nothing is left of what was known

  static constexpr int kMost = 4096;

  EqualPieces(Scalar dt_s, Scalar longest_s) {
    constexpr Scalar kRounding = Scalar(1e-6);  // of an interval that is one piece long
    const Scalar pieces = std::ceil(dt_s / longest_s - kRounding);
    const bool few = pieces <= kMost;
    count = few ? static_cast<int>(std::max(pieces, Scalar(1))) : 1;
    length_s = few ? dt_s / static_cast<Scalar>(count) : std::numeric_limits<Scalar>::quiet_NaN();
  }
};

}  // namespace truebearing
