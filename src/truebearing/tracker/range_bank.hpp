// SPDX-License-Identifier: Apache-2.0
// A bank of filters of bearings, with frequencies or without, that begins with the first of them: one filter for each
// of the hypotheses on range and velocity (range-parametrised filter: Peach 1995).
#pragma once

#include <memory>

#include "truebearing/filter/filter_kinds.hpp"
#include "truebearing/tracker/any_sensor.hpp"
#include "truebearing/tracker/range_hypotheses.hpp"
#include "truebearing/tracker/tracker.hpp"

namespace truebearing {

/// Nothing where the kind of filter is not compiled for the motion's states.
std::unique_ptr<Tracker> range_bank(const StateSpace& space, FilterKind filter,
                                    const std::shared_ptr<const AnyMotion>& motion, std::unique_ptr<AnySensor> sensor,
                                    const RangeHypotheses& hypotheses);

}  // namespace truebearing
