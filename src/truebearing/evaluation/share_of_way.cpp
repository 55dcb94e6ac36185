// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/share_of_way.hpp"

#include "truebearing/core/constants.hpp"

namespace truebearing {

double share_of_way(double rmse, double from, double bound) {
  return bound < from ? (from - rmse) / (from - bound) : kNaN;
}

double WayToBound::share(const TrackerSummary& tracker, const std::string& quantity) const {
  const QuantitySummary* of = tracker.quantity(quantity);
  const QuantitySummary* start = from ? from->quantity(quantity) : nullptr;
  const QuantitySummary* end = to ? to->quantity(quantity) : nullptr;
  return of && start && end ? share_of_way(of->rmse, start->rmse, end->rmse) : kNaN;
}

WayToBound way_to_bound(const Comparison& comparison) {
  WayToBound way{comparison.tracker("tuned"), nullptr};
  for (const std::string& bound : comparison.bounds)
    if (!way.to && bound != "tuned") way.to = comparison.tracker(bound);
  return way;
}

}  // namespace truebearing
