// SPDX-License-Identifier: Apache-2.0
// The lanes of a pack (state_pack.hpp): how many there are, and some of them.
#pragma once

#include <bit>
#include <cstdint>

namespace truebearing {

inline constexpr int kPackLanes = 8;
/// Some of the lanes: lane i by bit i.
using LaneMask = std::uint8_t;
inline constexpr LaneMask kAllLanes = 0xff;

constexpr LaneMask lane_bit(int lane) {
  return static_cast<LaneMask>(1u << static_cast<unsigned>(lane));
}
constexpr bool has_lane(LaneMask lanes, int lane) {
  return (lanes & lane_bit(lane)) != 0;
}
/// `lanes` but for `others`.
constexpr LaneMask without(LaneMask lanes, LaneMask others) {
  return static_cast<LaneMask>(lanes & ~others);
}
/// The lowest of some lanes; kPackLanes of none.
constexpr int first_lane(LaneMask lanes) {
  return std::countr_zero(lanes);
}
/// body(lane) for each, from the lowest on.
template <typename Body>
constexpr void for_each_lane(LaneMask lanes, const Body& body) {
  for (unsigned left = lanes; left != 0; left &= left - 1) body(std::countr_zero(left));
}

}  // namespace truebearing
