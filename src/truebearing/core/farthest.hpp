// SPDX-License-Identifier: Apache-2.0
// How far away a target can be.
#pragma once

namespace truebearing {

/// No target is farther away than this, which on Earth is a quarter round: what lies beyond is a mistake of units or of
/// arithmetic, so that trackers give up there and logs that begin there are warned of.
inline constexpr double kFarthest_m = 1e7;

}  // namespace truebearing
