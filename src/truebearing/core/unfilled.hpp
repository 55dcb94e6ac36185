// SPDX-License-Identifier: Apache-2.0
// For optional::emplace(), which by itself would first fill with zeros all that a block of a record has room for.
#pragma once

namespace truebearing {

struct Unfilled {
  template <typename Block>
  operator Block() const {  // NOLINT: that is what it is for
    Block block;
    return block;
  }
};

}  // namespace truebearing
