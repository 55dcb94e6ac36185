// SPDX-License-Identifier: Apache-2.0
// A hash by which a file says what it belongs to: FNV-1a of 64 bits (Fowler, Noll and Vo) where it takes bytes, and the
// same step for longer words. It finds out mistakes, not forgers.
#pragma once

#include <cstdint>

namespace truebearing {

class ContentHash {
 public:
  /// A byte, or a longer word at once.
  void take(std::uint64_t word) { value_ = (value_ ^ word) * 0x100000001b3U; }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325U;
};

}  // namespace truebearing
