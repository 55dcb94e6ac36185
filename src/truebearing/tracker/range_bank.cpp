// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tracker/range_bank.hpp"

#include <cmath>
#include <utility>
#include <vector>

#include "truebearing/tracker/filter_bank.hpp"

namespace truebearing {

std::unique_ptr<Tracker> range_bank(const StateSpace& space, FilterKind filter,
                                    const std::shared_ptr<const AnyMotion>& motion, std::unique_ptr<AnySensor> sensor,
                                    const RangeHypotheses& hypotheses) {
  const auto size = static_cast<std::size_t>(hypotheses.size());
  std::unique_ptr<FilterGroup> group = make_filter_group(filter, {motion}, std::vector<FilterGroup::Member>(size));
  if (!group) return nullptr;
  const int states = motion->states();
  const std::shared_ptr<const AnySensor> looked_at = sensor->fresh();
  const auto suppose = [hypotheses, looked_at, states](const Measurement& first,
                                                       const std::optional<TargetGuess>& guess,
                                                       std::span<FilterBank::Hypothesis> bank) {
    if (!hypotheses.prior.suffices_with(guess)) return false;
    const std::optional<Sight> sight = looked_at->sight(first);
    // Sectors of courses know more of the velocity along the ground than of the climb.
    const double climb_sigma_mps = std::isnan(hypotheses.prior.climb_sigma_mps) && hypotheses.velocity_cells > 1
                                       ? hypotheses.prior.velocity_sigma_mps
                                       : hypotheses.prior.climb_sigma_mps;
    for (std::size_t i = 0; i < bank.size(); ++i) {
      const RangeHypotheses::Weighted weighted =
          hypotheses.at(static_cast<int>(i), sight->bearing_rad, sight->sigma_rad, sight->from, guess);
      const std::optional<PriorStart> start = looked_at->believe(weighted.state, first);
      if (!start) return false;
      const PriorStart whole = lengthened(with_climb(*start, climb_sigma_mps), states, 0.0);
      bank[i] = {whole.x, whole.P, weighted.log_weight};
    }
    return true;
  };
  std::vector<std::unique_ptr<AnySensor>> sensors;
  sensors.push_back(std::move(sensor));
  return std::make_unique<FilterBank>(space, std::move(group), std::move(sensors),
                                      std::vector<FilterBank::Hypothesis>(size), suppose);
}

}  // namespace truebearing
