// SPDX-License-Identifier: Apache-2.0
// Four doubles that are worked on together, in the vector extension of GCC and Clang: a register of AVX, two of SSE2.
// What is padded to kLanes rows can be loaded in these without a rest. References, because without AVX there is no
// agreed way to pass them by value; everything is inlined into loops of simd_dispatch.hpp.
#pragma once

namespace truebearing {

inline constexpr int kLanes = 4;
/// The least multiple of kLanes that holds so many.
constexpr int padded_to_lanes(int count) {
  return (count + kLanes - 1) / kLanes * kLanes;
}
using Lanes [[gnu::vector_size(kLanes * sizeof(double))]] = double;

namespace detail {
using LanesInMemory [[gnu::vector_size(kLanes * sizeof(double)), gnu::aligned(alignof(double)), gnu::may_alias]] =
    double;
}

[[gnu::always_inline]] inline void load(const double* from, Lanes& lanes) {
  lanes = *reinterpret_cast<const detail::LanesInMemory*>(from);
}
[[gnu::always_inline]] inline void store(const Lanes& lanes, double* to) {
  *reinterpret_cast<detail::LanesInMemory*>(to) = lanes;
}
[[gnu::always_inline]] inline double sum(const Lanes& lanes) {
  return (lanes[0] + lanes[2]) + (lanes[1] + lanes[3]);
}

}  // namespace truebearing
