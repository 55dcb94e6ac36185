// SPDX-License-Identifier: Apache-2.0
// The fixes of one target as a file has them, and what is taken out of them before they are a track: repetitions,
// receivers without a position, positions that it could not have reached, velocities that no target has.
#pragma once

#include <cmath>
#include <cstddef>
#include <Eigen/Core>
#include <limits>
#include <string>
#include <vector>

#include "truebearing/core/constants.hpp"

namespace truebearing {

struct GeographicFix {
  double time_s;
  double latitude_deg;  // NaN, both, where there is none
  double longitude_deg;
  Eigen::Vector2d velocity_mps{kNaN, kNaN};  // East, North, as the target itself said
  double altitude_m = kNaN;                  // above the ellipsoid; NaN where there is none

  bool is_missing() const { return std::isnan(latitude_deg); }
  bool operator==(const GeographicFix& other) const {
    const auto same = [](double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); };
    return time_s == other.time_s && ((is_missing() && other.is_missing()) ||
                                      (latitude_deg == other.latitude_deg && longitude_deg == other.longitude_deg &&
                                       same(altitude_m, other.altitude_m)));
  }
};

struct GeographicTarget {
  std::string name;
  std::vector<GeographicFix> fixes;
  double latest_s = -std::numeric_limits<double>::infinity();
  int repeated = 0;
  int glitches = 0;
  int wrong_velocities = 0;
};

/// Puts late fixes in order and drops those that say what the one before says.
void put_in_order(GeographicTarget& target);

/// Takes out the fixes at 0, 0, which receivers without a position write, and returns how many. A target that was near
/// there may well have been there too.
std::size_t remove_null_island(GeographicTarget& target);

/// Takes out the fixes that no target could have reached in time: all but those of the longest chain, so that a wrong
/// position, be it the first, does not lock out the good ones. Of two first fixes the one counts from which the target
/// goes on as it came.
void remove_glitches(GeographicTarget& target, double max_speed_mps);

/// Takes out the fixes without an altitude, which are no places in space.
void remove_without_altitude(GeographicTarget& target);

/// Takes out the velocities that no target has.
void remove_wrong_velocities(GeographicTarget& target, double max_speed_mps);

}  // namespace truebearing
