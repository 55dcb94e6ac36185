// The bounds of several targets' angles over the runs of a comparison.
#pragma once

#include <string>
#include <vector>

#include "truebearing/evaluation/angle_bound.hpp"
#include "truebearing/evaluation/metric.hpp"

namespace truebearing {

/// A bound's variances as a comparison gives a tracker's squared errors.
struct AngleBoundSummary {
  struct Quantity {
    std::string name;            ///< as in angle_space(): "angle_deg", "rate_degps"
    Metric mse;                  ///< mean of the variance over runs, targets and scored steps
    double rmse = 0.0;           ///< its root
    std::vector<double> series;  ///< root of the mean over runs and targets at each step; NaN where there is none
  };
  std::string name;
  std::vector<Quantity> quantities;
};

/// runs: [run]. Two bounds: `cramer_rao_apart`, of the angle, over the intervals in which a target is apart from every
/// other, for where targets meet it is infinite; `posterior`, of angle and rate, over all. Their metrics are `mse` and
/// `rate_mse`.
std::vector<AngleBoundSummary> summarise_angle_bounds(const std::vector<const AngleVariances*>& runs);

}  // namespace truebearing
