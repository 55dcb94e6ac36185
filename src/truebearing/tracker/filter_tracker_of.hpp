// SPDX-License-Identifier: Apache-2.0
// A FilterTracker of a filter, a motion and a sensor of known types, for whoever writes a program rather than a study:
//     FilterTrackerOf<KalmanFilter<4>, ConstantVelocity<2, DiscreteWhiteNoise>, PositionSensor<2>>
//         tracker(plane_space(), motion, sensor, TwoPointStart{});
#pragma once

#include <utility>

#include "truebearing/filter/filter_kinds.hpp"
#include "truebearing/tracker/filter_tracker.hpp"

namespace truebearing {

template <typename Filter, typename Motion, typename Sensor>
class FilterTrackerOf final : public FilterTracker {
 public:
  FilterTrackerOf(const StateSpace& space, Motion motion, Sensor sensor, Start start, FilterTrackerOptions options = {})
      : FilterTracker(space, state_of<Filter>(std::move(motion)), sensor_of(std::move(sensor)), std::move(start),
                      options) {}
};

}  // namespace truebearing
