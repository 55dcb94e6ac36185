// SPDX-License-Identifier: Apache-2.0
// The problem that all batch solvers for bearings share: the first m bearings of Cho's first scenario that are not
// masked by a turn, sigma 1 degree, and the 225 starts of his grid. Times are per whole solve of all starts.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace truebearing::bench {

struct BearingsProblem {
  struct Bearing {
    double time_s;  ///< from the first
    Eigen::Vector2d own_ship_m;
    double bearing_rad;
  };
  std::vector<Bearing> bearings;
  double sigma_rad = 0.0;
  /// [east, north, v_east, v_north] at the first bearing, in m and m/s (cho_2015.hpp).
  std::vector<Eigen::Vector4d> starts;
};

BearingsProblem bearings_problem(int bearings);

inline constexpr int kMostIterations = 10;
inline constexpr int kProblemSizes[] = {60, 200, 1000};

}  // namespace truebearing::bench
