// SPDX-License-Identifier: Apache-2.0
// Trackers of bearings for the tests of several rooms.
#pragma once

#include <memory>
#include <vector>

#include "tests/support/bearings.hpp"
#include "truebearing/filter/kalman.hpp"
#include "truebearing/filter/log_polar.hpp"
#include "truebearing/motion/constant_velocity.hpp"
#include "truebearing/tracker/bearing_sensor.hpp"
#include "truebearing/tracker/filter_tracker_of.hpp"
#include "truebearing/tracker/range_bank.hpp"

namespace truebearing::testing {

using BearingMotion = ConstantVelocity<2, ContinuousWhiteNoise>;
template <typename Filter>
using BearingTracker = FilterTrackerOf<Filter, BearingMotion, BearingSensor>;

/// The guess from the measurements, velocities of 4 m/s per axis.
inline RangePrior guessed_range() {
  RangePrior prior;
  prior.velocity_sigma_mps = 4.0;
  return prior;
}

template <typename Filter>
std::unique_ptr<Tracker> bearing_tracker(FilterTrackerOptions options = {}) {
  return std::make_unique<BearingTracker<Filter>>(plane_space(), BearingMotion{{1e-6}},
                                                  BearingSensor{radians(1.0), 1.0}, guessed_range(), options);
}

/// A bank of extended filters on `hypotheses`.
inline std::unique_ptr<Tracker> range_bank(const RangeHypotheses& hypotheses) {
  return truebearing::range_bank(plane_space(), FilterKind::kalman, erased(BearingMotion{{1e-6}}),
                                 sensor_of(BearingSensor{radians(1.0), 1.0}), hypotheses);
}

}  // namespace truebearing::testing
