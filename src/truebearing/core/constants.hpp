// SPDX-License-Identifier: Apache-2.0
// The two numbers that say "not known" and "no limit".
#pragma once

#include <limits>

namespace truebearing {

inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace truebearing
