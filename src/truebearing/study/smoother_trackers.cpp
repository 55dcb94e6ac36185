// SPDX-License-Identifier: Apache-2.0
#include "truebearing/study/smoother_trackers.hpp"

#include "truebearing/core/error.hpp"
#include "truebearing/tracker/smoothing_tracker.hpp"

namespace truebearing {

bool can_be_smoothed(const Tracker& tracker) {
  const auto* filter = dynamic_cast<const FilterTracker*>(&tracker);
  return filter && filter->options().output_pull == 0.0 && filter->options().ahead_s == 0.0;
}

std::unique_ptr<Tracker> make_smoother(std::unique_ptr<Tracker> filter, const SmootherSpec& spec,
                                       const std::string& where) {
  if (!can_be_smoothed(*filter))
    throw InputError(where + ".of", "is \"" + spec.of + "\", which there is no smoother of",
                     "a filter or an imm without output_pull and ahead_s");
  return std::make_unique<SmoothingTracker>(
      std::unique_ptr<FilterTracker>(static_cast<FilterTracker*>(filter.release())), spec.lag_s);
}

}  // namespace truebearing
