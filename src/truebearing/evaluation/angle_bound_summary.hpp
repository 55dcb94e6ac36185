// SPDX-License-Identifier: Apache-2.0
// The bounds of several targets' angles over the runs of a comparison.
#pragma once

#include <string>
#include <vector>

#include "truebearing/evaluation/angle_bound.hpp"
#include "truebearing/evaluation/metric.hpp"
#include "truebearing/evaluation/samples.hpp"

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

/// Takes the variances of run by run in the order of their numbers, and keeps their sums. Two bounds:
/// `cramer_rao_apart`, of the angle, over the intervals in which a target is apart from every other, for where targets
/// meet it is infinite; `posterior`, of angle and rate, over all. Their metrics are `mse` and `rate_mse`.
class AngleBoundTally {
 public:
  void add(const AngleVariances& run);
  void exchange(TallyStream& stream);
  std::vector<AngleBoundSummary> summaries() const;

 private:
  // Of one quantity of one bound.
  struct Sums {
    template <typename Variance>
    void add(const AngleVariances& run, const Variance& variance);
    AngleBoundSummary::Quantity summary(const char* name, const char* metric) const;

    RunErrors runs;
    std::vector<SquaredErrors> steps;
  };
  Sums apart_, angle_, rate_;
};

/// The same of all runs at once: [run].
std::vector<AngleBoundSummary> summarise_angle_bounds(const std::vector<const AngleVariances*>& runs);

}  // namespace truebearing
