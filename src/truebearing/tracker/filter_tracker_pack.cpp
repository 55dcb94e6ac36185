// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tracker/filter_tracker_pack.hpp"

#include <array>
#include <cmath>

#include "truebearing/core/unfilled.hpp"
#include "truebearing/tracker/publishable.hpp"

namespace truebearing {

std::unique_ptr<TrackerPack> FilterTracker::pack() const {
  if (ahead_ || options_.output_pull > 0.0) return nullptr;
  std::shared_ptr<StatePack> states = pack_of(*state_);
  return states ? std::make_unique<FilterTrackerPack>(std::move(states)) : nullptr;
}

void FilterTrackerPack::step(std::span<Lane> lanes) {
  std::array<Lane*, kPackLanes> in{};  // of the pack's lanes, those that are stepped together
  std::array<double, kPackLanes> dt_s{};
  std::array<const AnyMeasurement*, kPackLanes> taken{};
  const auto tracker_of = [](const Lane& lane) -> FilterTracker& { return static_cast<FilterTracker&>(*lane.tracker); };
  const auto each_of = [&](LaneMask some, const auto& body) {
    for_each_lane(some, [&](int place) {
      Lane& lane = *in[static_cast<std::size_t>(place)];
      body(place, tracker_of(lane), lane);
    });
  };

  LaneMask together = 0;
  for (Lane& lane : lanes) {
    lane.records = {};
    if (!lane.measurement) continue;
    FilterTracker& tracker = tracker_of(lane);
    if (const auto records = tracker.open(*lane.measurement)) {
      lane.records = *records;
      continue;
    }
    if (!tracker.is_ordinary(*lane.measurement) || !find_place(tracker)) {
      lane.records = tracker.go_on(*lane.measurement);
      continue;
    }
    const int place = tracker.place_.lane();
    together |= lane_bit(place);
    in[static_cast<std::size_t>(place)] = &lane;
    dt_s[static_cast<std::size_t>(place)] = lane.measurement->time_s - tracker.used_time_s_;
  }
  if (together == 0) return;

  const int positions = tracker_of(lanes.front()).published_ / 2;
  const auto sensible = [&](LaneMask some) { return states_->within(some, positions, kFarthest_m); };
  LaneMask done = sensible(states_->predict(together, dt_s.data()));
  each_of(done, [&](int place, FilterTracker& tracker, Lane& lane) {
    tracker.begin_record(*lane.measurement);
    Prediction& prediction = tracker.record_.prediction.emplace(Unfilled());
    tracker.copy_published(*states_, place, prediction.x, prediction.P);
    taken[static_cast<std::size_t>(place)] = &tracker.sensor_->take(*lane.measurement, prediction);
  });
  done = sensible(states_->update(done, taken.data()));
  each_of(done, [&](int place, FilterTracker& tracker, Lane& lane) {
    if (tracker.settle(*states_, place, *lane.measurement, *taken[static_cast<std::size_t>(place)]))
      lane.records = {&tracker.record_, 1};
    else
      done = without(done, lane_bit(place));
  });
  // Those that go on alone take with them what was held before this step.
  each_of(without(together, done),
          [](int, FilterTracker& tracker, Lane& lane) { lane.records = tracker.go_on(*lane.measurement); });
  states_->keep(done);
}

// False where all lanes are others'.
bool FilterTrackerPack::find_place(FilterTracker& tracker) {
  if (tracker.place_.is_in(states_)) return true;
  const int free = states_->free_lane();
  if (free < 0) return false;
  states_->enter(free, tracker.state());
  tracker.place_ = PlaceInPack(states_, free);
  return true;
}

// The rest shows when the filter has been asked.
bool FilterTracker::is_ordinary(const Measurement& measurement) const {
  const double dt_s = measurement.time_s - used_time_s_;
  return usable_ && dt_s > 0.0 && dt_s <= options_.lost_after_s;
}

// What go_on() comes to, where nothing out of the ordinary happens. False, and nothing decided, otherwise.
bool FilterTracker::settle(const StatePack& pack, int lane, const Measurement& measurement,
                           const AnyMeasurement& taken) {
  Innovation& innovation = record_.innovation.emplace(Unfilled());
  BoundedMatrix& gain = record_.gain.emplace();
  pack.update_of(lane, {innovation.nu, innovation.S, gain, innovation.nis});
  Gate& gate = gate_of(measurement);
  if (!std::isfinite(innovation.nis) || innovation.nis > gate.threshold()) return false;
  copy_published(pack, lane, record_.x, record_.P);
  gate.judge(innovation.nis);
  forget_challenger();
  failed_in_row_ = 0;
  with_length(taken, [&](const auto& sized) { innovation.z = sized.z; });
  if (published_ < state_->size()) gain.conservativeResize(published_, Eigen::NoChange);
  if (state_->mode_probabilities()) pack.mode_probabilities(lane, record_.mode_probabilities.emplace());
  record_.status = StepStatus::ok;
  passage_.used = true;
  used_time_s_ = measurement.time_s;
  return true;
}

void FilterTracker::fetch_state() const {
  if (place_) place_.leave(*state_);
}

}  // namespace truebearing
