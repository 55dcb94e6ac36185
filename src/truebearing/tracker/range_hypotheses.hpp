// SPDX-License-Identifier: Apache-2.0
// Hypotheses of a bank on a target whose first bearing has come in: its range cut into intervals in geometric
// progression (Peach 1995), its velocity into sectors of courses. Each has the mean and covariance of what the prior
// says given that cell, and the cell's probability for weight, so that together they have the prior's own.
#pragma once

#include <optional>
#include <utility>

#include "truebearing/tma/range_prior.hpp"

namespace truebearing {

struct RangeHypotheses {
  RangePrior prior;
  int ranges = 1;          ///< number of intervals
  int velocity_cells = 1;  ///< 1, or sectors of courses, 3 or more, of a prior whose velocity is about zero
  double least_range_m = 0.0;
  /// Where speeds of a family lie, uniformly; absent: velocities are normal, as the prior has them.
  std::optional<std::pair<double, double>> speed_between_mps{};

  int size() const { return ranges * velocity_cells; }

  struct Weighted {
    GaussianState state;
    double log_weight;
  };
  /// Number i of size() of them, for a bearing and the guess that came with it. The prior must suffice with the guess.
  /// Intervals lie between the prior's ends, or without these 2.5 standard deviations about the mean, but no closer
  /// than 5 % of the mean and no closer than least_range_m.
  Weighted at(int i, double bearing_rad, double sigma_rad, const SensorState& sensor,
              const std::optional<TargetGuess>& guess) const;
};

}  // namespace truebearing
