// SPDX-License-Identifier: Apache-2.0
// Whether own ship went where its velocity took it: a jump of its positions, or another unit.
#pragma once

#include <string>

#include "app/tma_log.hpp"

namespace truebearing {

/// Where own ship's positions and its velocity, if the log has one, disagree grossly: in words, else empty.
std::string own_ship_is_off(const TmaWindows& windows);

}  // namespace truebearing
