// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/angle_bound_summary.hpp"

#include <algorithm>
#include <cmath>

namespace truebearing {

// The variance of a run at a place; NaN for one that does not count.
template <typename Variance>
void AngleBoundTally::Sums::add(const AngleVariances& run, const Variance& variance) {
  const std::size_t count = run.steps();
  SquaredErrors of_run;
  steps.resize(std::max(steps.size(), count));
  for (std::size_t place = 0; place < run.targets * count; ++place) {
    const SquaredErrors one{variance(place), 1.0};
    if (std::isnan(one.sum)) continue;
    of_run.add(one);
    steps[place % count].add(one);
  }
  runs.add(of_run);
}

AngleBoundSummary::Quantity AngleBoundTally::Sums::summary(const char* name, const char* metric) const {
  const Estimate mse = runs.mse();
  AngleBoundSummary::Quantity quantity;
  quantity.name = name;
  quantity.mse = {metric, squared_unit_of(name), std::nullopt, mse.value, mse.se};
  quantity.rmse = std::sqrt(mse.value);
  for (const SquaredErrors& step : steps) quantity.series.push_back(root_mean(step));
  return quantity;
}

void AngleBoundTally::add(const AngleVariances& run) {
  apart_.add(run, [&](std::size_t place) { return run.apart[place] ? run.cramer_rao_deg2[place] : std::nan(""); });
  angle_.add(run, [&](std::size_t place) { return run.posterior_deg2[place]; });
  rate_.add(run, [&](std::size_t place) { return run.posterior_deg2ps2[place]; });
}

void AngleBoundTally::exchange(TallyStream& stream) {
  for (Sums* sums : {&apart_, &angle_, &rate_}) {
    sums->runs.exchange(stream);
    stream.list(sums->steps, [&](SquaredErrors& step) { truebearing::exchange(step, stream); });
  }
}

std::vector<AngleBoundSummary> AngleBoundTally::summaries() const {
  return {{"cramer_rao_apart", {apart_.summary("angle_deg", "mse")}},
          {"posterior", {angle_.summary("angle_deg", "mse"), rate_.summary("rate_degps", "rate_mse")}}};
}

std::vector<AngleBoundSummary> summarise_angle_bounds(const std::vector<const AngleVariances*>& runs) {
  AngleBoundTally tally;
  for (const AngleVariances* run : runs) tally.add(*run);
  return tally.summaries();
}

}  // namespace truebearing
