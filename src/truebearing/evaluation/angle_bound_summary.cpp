#include "truebearing/evaluation/angle_bound_summary.hpp"

#include <algorithm>
#include <cmath>

#include "truebearing/evaluation/statistics.hpp"

namespace truebearing {
namespace {

using Runs = std::vector<const AngleVariances*>;

// The variance of a run at a place; NaN for one that does not count.
template <typename Variance>
AngleBoundSummary::Quantity summarise(const char* name, const char* metric, const Runs& runs,
                                      const Variance& variance) {
  std::vector<SquaredErrors> of_runs, of_steps;
  for (const AngleVariances* run : runs) {
    const std::size_t steps = run->steps();
    of_runs.emplace_back();
    of_steps.resize(std::max(of_steps.size(), steps));
    for (std::size_t place = 0; place < run->targets * steps; ++place) {
      const SquaredErrors one{variance(*run, place), 1.0};
      if (std::isnan(one.sum)) continue;
      of_runs.back().add(one);
      of_steps[place % steps].add(one);
    }
  }
  const Estimate mse = pooled_mse(of_runs);
  AngleBoundSummary::Quantity quantity;
  quantity.name = name;
  quantity.mse = {metric, squared_unit_of(name), std::nullopt, mse.value, mse.se};
  quantity.rmse = std::sqrt(mse.value);
  for (const SquaredErrors& step : of_steps) quantity.series.push_back(root_mean(step));
  return quantity;
}

}  // namespace

std::vector<AngleBoundSummary> summarise_angle_bounds(const Runs& runs) {
  const auto apart = [](const AngleVariances& run, std::size_t place) {
    return run.apart[place] ? run.cramer_rao_deg2[place] : std::nan("");
  };
  const auto angle = [](const AngleVariances& run, std::size_t place) { return run.posterior_deg2[place]; };
  const auto rate = [](const AngleVariances& run, std::size_t place) { return run.posterior_deg2ps2[place]; };
  return {{"cramer_rao_apart", {summarise("angle_deg", "mse", runs, apart)}},
          {"posterior", {summarise("angle_deg", "mse", runs, angle), summarise("rate_degps", "rate_mse", runs, rate)}}};
}

}  // namespace truebearing
