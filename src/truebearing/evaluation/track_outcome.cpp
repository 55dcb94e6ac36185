// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/track_outcome.hpp"

#include <cmath>
#include <vector>

#include "truebearing/evaluation/statistics.hpp"

namespace truebearing {
namespace {

// The last steps at which there is a value.
std::vector<std::size_t> last_known(std::span<const double> values, int count) {
  std::vector<std::size_t> steps;
  for (std::size_t step = values.size(); step-- > 0 && std::ssize(steps) < count;)
    if (!std::isnan(values[step])) steps.push_back(step);
  return steps;
}

// Of a - b over the steps at which both are known; NaN where there is no such step.
double mean_difference(std::span<const double> a, std::span<const double> b, const std::vector<std::size_t>& steps) {
  std::vector<double> differences;
  for (const std::size_t step : steps)
    if (const double d = a[step] - b[step]; !std::isnan(d)) differences.push_back(d);
  return mean_of(differences).value;
}

}  // namespace

TrackOutcome track_outcome(std::span<const double> truth, std::span<const double> estimates, std::size_t targets,
                           const TrackRule& rule) {
  const std::size_t steps = truth.size() / targets;
  const auto of = [&](std::span<const double> values, std::size_t target) {
    return values.subspan(target * steps, steps);
  };
  TrackOutcome outcome;
  for (std::size_t target = 0; target < targets; ++target) {
    const std::span<const double> track = of(estimates, target);
    for (std::size_t step = 0; step < steps; ++step)
      outcome.excursion |= std::abs(of(truth, target)[step] - track[step]) > rule.excursion;

    const std::vector<std::size_t> last = last_known(of(truth, target), rule.last_steps);
    const auto follows = [&](std::size_t other) {  // false where the track has no estimate there
      return std::abs(mean_difference(of(truth, other), track, last)) <= rule.bad;
    };
    if (last.empty() || follows(target)) continue;
    bool elsewhere = false;
    for (std::size_t other = 0; other < targets; ++other) elsewhere |= other != target && follows(other);
    ++(elsewhere ? outcome.swapped : outcome.lost);
  }
  return outcome;
}

}  // namespace truebearing
