// A multiple-model tracker of bearings, with frequencies or without, whose modes share one kind of filter.
#pragma once

#include <algorithm>

#include "truebearing/filter/interacting_multiple_model.hpp"
#include "truebearing/filter/kalman.hpp"
#include "truebearing/filter/modified_gain.hpp"
#include "truebearing/filter/unscented.hpp"
#include "truebearing/study/bearing_trackers.hpp"
#include "truebearing/study/multiple_model_configuration.hpp"

namespace truebearing {

template <typename Filter, typename Motion, typename Sensor>
std::unique_ptr<Tracker> bearing_multiple_model(TableReader& table, const StateSpace& space,
                                                const std::vector<Motion>& motions, const Sensor& sensor) {
  using OneMode = Mode<Filter, Motion>;
  MultipleModels<OneMode> models{{}, read_chain(table, static_cast<int>(motions.size()))};
  for (const Motion& motion : motions) models.modes.push_back(OneMode{motion});
  return bearing_tracker<InteractingMultipleModel<OneMode>>(table, space, models, sensor);
}

/// filter = "kalman" | "unscented" | "modified_gain", over N states.
template <int N, typename Motion, typename Sensor>
std::unique_ptr<Tracker> bearing_multiple_model(TableReader& table, const StateSpace& space,
                                                const std::vector<Motion>& motions, const Sensor& sensor) {
  const std::string filter = table.choice_or("filter", {"kalman", "unscented", "modified_gain"}, "kalman");
  if (filter == "unscented") return bearing_multiple_model<UnscentedKalmanFilter<N>>(table, space, motions, sensor);
  if (filter == "modified_gain") return bearing_multiple_model<ModifiedGainFilter<N>>(table, space, motions, sensor);
  return bearing_multiple_model<KalmanFilter<N>>(table, space, motions, sensor);
}

/// The motions as `Motion`; an error where one is of another kind.
template <typename Motion, typename Any>
std::vector<Motion> all_of_kind(const std::vector<Any>& motions, const TableReader& table) {
  std::vector<Motion> all;
  for (const Any& any : motions) {
    const auto* motion = std::get_if<Motion>(&any);
    if (!motion)
      throw table.error("modes", "are of unequal states, which no multiple-model tracker of bearings mixes",
                        "modes that are all without accelerations, or all with them");
    all.push_back(*motion);
  }
  return all;
}

}  // namespace truebearing
