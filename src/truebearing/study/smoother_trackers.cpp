// SPDX-License-Identifier: Apache-2.0
#include "truebearing/study/smoother_trackers.hpp"

#include "truebearing/core/error.hpp"
#include "truebearing/tracker/smoothing_bank.hpp"
#include "truebearing/tracker/smoothing_tracker.hpp"

namespace truebearing {

namespace {

constexpr const char* kCanBeSmoothed = "a filter, an imm or a bank, without output_pull and ahead_s";

}  // namespace

bool can_be_smoothed(const Tracker& tracker) {
  if (dynamic_cast<const FilterBank*>(&tracker)) return true;
  const auto* filter = dynamic_cast<const FilterTracker*>(&tracker);
  return filter && filter->options().output_pull == 0.0 && filter->options().ahead_s == 0.0;
}

std::unique_ptr<Tracker> make_smoother(std::unique_ptr<Tracker> filter, const SmootherSpec& spec,
                                       const std::string& where) {
  if (!can_be_smoothed(*filter))
    throw InputError(where + ".of", "is \"" + spec.of + "\", which there is no smoother of", kCanBeSmoothed);
  if (dynamic_cast<const FilterBank*>(filter.get()))
    return std::make_unique<SmoothingBank>(std::unique_ptr<FilterBank>(static_cast<FilterBank*>(filter.release())),
                                           spec.lag_s);
  return std::make_unique<SmoothingTracker>(
      std::unique_ptr<FilterTracker>(static_cast<FilterTracker*>(filter.release())), spec.lag_s);
}

}  // namespace truebearing
