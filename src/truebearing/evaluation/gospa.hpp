// SPDX-License-Identifier: Apache-2.0
// GOSPA, the generalised optimal sub-pattern assignment metric, p = 2 and alpha = 2, between the true values x (n) of a
// scalar quantity and those that tracks give (m):
//
//     d^2 = min over assignments of  sum of assigned (x_i - y_j)^2 + c^2 / 2 (missed targets + false tracks)
//
// Rahmathullah, Garcia-Fernandez and Svensson 2017, proposition 1. Of a squared cost on a line the best assignment
// never crosses, so that it is found exactly by dynamic programming over both lists in ascending order.
#pragma once

#include <span>
#include <vector>

namespace truebearing {

struct Gospa {
  double localisation = 0.0;  ///< sum of the squared distances of the assigned
  int missed = 0;             ///< targets without a track
  int false_tracks = 0;       ///< tracks without a target
  std::vector<int> track_of;  ///< [target]: place of its track, -1 where it is missed

  /// d^2 for the cutoff c.
  double squared(double cutoff) const {
    return localisation + 0.5 * cutoff * cutoff * static_cast<double>(missed + false_tracks);
  }
};

/// All values finite. A pair farther apart than the cutoff (> 0) is never assigned.
Gospa gospa(std::span<const double> targets, std::span<const double> tracks, double cutoff);

}  // namespace truebearing
