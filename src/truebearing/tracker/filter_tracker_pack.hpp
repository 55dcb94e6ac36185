// SPDX-License-Identifier: Apache-2.0
// FilterTrackers stepped together. An ordinary step, a usable measurement later than the last that was used, which the
// gate lets pass and the filter takes without ado, goes through a StatePack; a tracker that meets anything else takes
// that step by itself.
#pragma once

#include <memory>
#include <utility>

#include "truebearing/tracker/filter_tracker.hpp"
#include "truebearing/tracker/tracker_pack.hpp"

namespace truebearing {

class FilterTrackerPack final : public TrackerPack {
 public:
  explicit FilterTrackerPack(std::shared_ptr<StatePack> states) : states_(std::move(states)) {}

  void step(std::span<Lane> lanes) override;

 private:
  bool find_place(FilterTracker& tracker);

  std::shared_ptr<StatePack> states_;
};

}  // namespace truebearing
