// SPDX-License-Identifier: Apache-2.0
// How far trackers come from "tuned", as studies call their honest baseline, to a bound:
//     share = (RMSE of tuned - RMSE) / (RMSE of tuned - RMSE of the bound)
// 0 for the tuned filter, 1 for the bound, below 0 for what is worse than tuned.
#pragma once

#include <string>

#include "truebearing/evaluation/comparison.hpp"

namespace truebearing {

/// NaN where the bound is not below `from`.
double share_of_way(double rmse, double from, double bound);

struct WayToBound {
  const TrackerSummary* from = nullptr;
  const TrackerSummary* to = nullptr;

  /// Both are there.
  explicit operator bool() const { return from && to; }
  /// Of a tracker in that quantity; NaN where one of the three does not have it.
  double share(const TrackerSummary& tracker, const std::string& quantity) const;
};

/// From "tuned" to the first tracker of the comparison that is a bound.
WayToBound way_to_bound(const Comparison& comparison);

}  // namespace truebearing
