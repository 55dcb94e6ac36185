// SPDX-License-Identifier: Apache-2.0
// What recorders of real flights do to positions: only some samples (knots) are received, each with an error of its
// time stamp, which moves it along the velocity; the others are linear interpolations between knots.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "truebearing/core/random.hpp"
#include "truebearing/simulation/distribution.hpp"

namespace truebearing {

struct RecorderJitter {
  std::vector<double> knots = {1.0};  ///< probability, by n - 1, that the next knot comes n samples later; sums to 1
  Distribution time_sigma_s = 0.0;    ///< standard deviation of the time stamps' error (Laplace), drawn once per track

  /// Samples that a track needs before and after those that are used, so that the knots do not begin with them.
  int margin() const { return static_cast<int>(knots.size()); }

  /// Positions (2 x N) as recorded, of a true track [position; velocity] (4 x N).
  Eigen::Matrix2Xd record(const Eigen::Matrix4Xd& track, RandomStream& stream) const;
};

}  // namespace truebearing
