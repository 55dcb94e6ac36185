// SPDX-License-Identifier: Apache-2.0
// Choices and numbers made of the bytes that a fuzzer gives; behind their end, zeros.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "truebearing/core/constants.hpp"

namespace truebearing::testing {

class Bytes {
 public:
  explicit Bytes(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  bool empty() const { return bytes_.empty(); }
  std::uint8_t take() {
    if (bytes_.empty()) return 0;
    const std::uint8_t byte = bytes_.front();
    bytes_ = bytes_.subspan(1);
    return byte;
  }
  std::uint64_t take(int count) {
    std::uint64_t value = 0;
    for (int i = 0; i < count; ++i) value = value << 8 | take();
    return value;
  }
  // Mostly a number of some magnitude from 1e-4 to 3e11, else one at an edge, else any double at all.
  double number() {
    constexpr std::array kEdges{0.0,   -0.0,  5e-324,  1e-308,   1e15,      1e30,
                                1e100, 1e154, 1.7e308, -1.7e308, kInfinity, kNaN};
    const unsigned kind = take();
    if (kind < 240) return static_cast<double>(static_cast<std::int16_t>(take(2))) * std::pow(10.0, int(kind % 12) - 4);
    if (kind < 240 + kEdges.size()) return kEdges[kind - 240];
    return std::bit_cast<double>(take(8));
  }
  /// One in four of the bytes chooses among so many others than 0, which is what is ordinary.
  unsigned choice(unsigned others) {
    const unsigned byte = take();
    return byte < 192 ? 0 : 1 + (byte - 192) % others;
  }
  double magnitude() { return std::abs(number()); }

 private:
  std::span<const std::uint8_t> bytes_;
};

}  // namespace truebearing::testing
