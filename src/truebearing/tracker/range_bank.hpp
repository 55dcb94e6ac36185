// A bank of filters of bearings, with frequencies or without, that begins with the first of them: one filter for each
// of the hypotheses on range and velocity (range-parametrised filter: Peach 1995).
#pragma once

#include <memory>
#include <vector>

#include "truebearing/tracker/filter_bank.hpp"
#include "truebearing/tracker/range_hypotheses.hpp"

namespace truebearing {

template <typename Filter, typename Motion, typename Sensor>
std::unique_ptr<Tracker> range_bank(const StateSpace& space, const Motion& motion, const Sensor& sensor,
                                    const RangeHypotheses& hypotheses) {
  using Bank = FilterBank<Filter, Motion, Sensor>;
  using Hypothesis = typename Bank::Hypothesis;
  const auto suppose = [hypotheses, sensor](const Measurement& first, const std::optional<TargetGuess>& guess,
                                            std::span<Hypothesis> bank) {
    if (!hypotheses.prior.suffices_with(guess)) return false;
    const auto model = sensor.model(first);
    const SensorState seen_from{model.site_m, model.site_velocity_mps};
    for (std::size_t i = 0; i < bank.size(); ++i) {
      const RangeHypotheses::Weighted weighted =
          hypotheses.at(static_cast<int>(i), sensor.value(first)[0], model.sigma_rad, seen_from, guess);
      const auto start = sensor.start(weighted.state, first);
      if (!start) return false;
      bank[i].start = Filter(start->x, start->P);
      bank[i].log_weight = weighted.log_weight;
      if (!bank[i].start.x().allFinite() || !bank[i].start.P().allFinite()) return false;
    }
    return true;
  };
  const Hypothesis unset{Filter(Filter::State::Zero(), Filter::Covariance::Identity()), motion, sensor};
  return std::make_unique<Bank>(space, std::vector<Hypothesis>(static_cast<std::size_t>(hypotheses.size()), unset),
                                suppose);
}

}  // namespace truebearing
