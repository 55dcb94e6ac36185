// SPDX-License-Identifier: Apache-2.0
// The lanes of a pack (state_pack.hpp): how many there are, and some of them.
#pragma once

#include <cstdint>

namespace truebearing {

inline constexpr int kPackLanes = 8;
/// Some of the lanes: lane i by bit i.
using LaneMask = std::uint8_t;

constexpr LaneMask lane_bit(int lane) {
  return static_cast<LaneMask>(1u << static_cast<unsigned>(lane));
}
constexpr bool has_lane(LaneMask lanes, int lane) {
  return (lanes & lane_bit(lane)) != 0;
}

}  // namespace truebearing
