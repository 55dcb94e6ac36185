// SPDX-License-Identifier: Apache-2.0
// From a small number known at run time to one known at compile time.
#pragma once

#include <type_traits>

namespace truebearing {

/// Calls body(std::integral_constant<int, count>) for a count of 1 to 10, as fixed sizes and unrolled loops want it,
/// and for any other with 0, which stands for a count that is not known beforehand.
template <typename Body>
[[gnu::always_inline]] inline void with_count(int count, const Body& body) {
  switch (count) {
    case 1:
      return body(std::integral_constant<int, 1>{});
    case 2:
      return body(std::integral_constant<int, 2>{});
    case 3:
      return body(std::integral_constant<int, 3>{});
    case 4:
      return body(std::integral_constant<int, 4>{});
    case 5:
      return body(std::integral_constant<int, 5>{});
    case 6:
      return body(std::integral_constant<int, 6>{});
    case 7:
      return body(std::integral_constant<int, 7>{});
    case 8:
      return body(std::integral_constant<int, 8>{});
    case 9:
      return body(std::integral_constant<int, 9>{});
    case 10:
      return body(std::integral_constant<int, 10>{});
    default:
      return body(std::integral_constant<int, 0>{});
  }
}

}  // namespace truebearing
