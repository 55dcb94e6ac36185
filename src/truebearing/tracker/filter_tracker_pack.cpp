// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tracker/filter_tracker_pack.hpp"

#include <array>
#include <cmath>

#include "truebearing/core/unfilled.hpp"
#include "truebearing/tracker/publishable.hpp"

namespace truebearing {

std::unique_ptr<TrackerPack> FilterTracker::pack() const {
  std::shared_ptr<StatePack> states = pack_of(*state_);
  if (!states || ahead_ || options_.output_pull > 0.0) return nullptr;
  return std::make_unique<FilterTrackerPack>(std::move(states));
}

void FilterTrackerPack::step(std::span<Lane> lanes) {
  if (lanes.empty()) return;
  std::array<double, kPackLanes> dt_s{};
  std::array<const AnyMeasurement*, kPackLanes> taken{};
  const auto tracker_in = [&](int lane) -> FilterTracker& {
    return static_cast<FilterTracker&>(*lanes[static_cast<std::size_t>(lane)].tracker);
  };
  const auto each_of = [&](LaneMask some, const auto& body) {
    for (int lane = 0; lane < static_cast<int>(lanes.size()); ++lane)
      if (has_lane(some, lane)) body(lane, tracker_in(lane), lanes[static_cast<std::size_t>(lane)]);
  };

  LaneMask waiting = 0;  // for their filters
  LaneMask together = 0;
  each_of(0xff, [&](int lane, FilterTracker& tracker, Lane& of_lane) {
    of_lane.records = {};
    if (!of_lane.measurement) return;
    if (const auto records = tracker.open(*of_lane.measurement)) {
      of_lane.records = *records;
      return;
    }
    waiting |= lane_bit(lane);
    if (!tracker.is_ordinary(*of_lane.measurement)) return;
    together |= lane_bit(lane);
    dt_s[static_cast<std::size_t>(lane)] = of_lane.measurement->time_s - tracker.used_time_s_;
    if (tracker.is_in_pack_ && tracker.pack_ == states_ && tracker.lane_ == lane) return;
    tracker.come_home();
    tracker.pack_ = states_;
    tracker.lane_ = lane;
    tracker.is_in_pack_ = true;
    states_->enter(lane, *tracker.state_);
  });

  const FilterTracker& any = tracker_in(0);
  const auto sensible = [&](LaneMask some) { return states_->within(some, any.space_->size() / 2, kFarthest_m); };
  LaneMask done = together == 0 ? LaneMask{0} : sensible(states_->predict(together, dt_s.data()));
  each_of(done, [&](int lane, FilterTracker& tracker, Lane& of_lane) {
    tracker.begin_record(*of_lane.measurement);
    Prediction& prediction = tracker.record_.prediction.emplace(Unfilled());
    tracker.show(*states_, lane, prediction.x, prediction.P);
    taken[static_cast<std::size_t>(lane)] = &tracker.sensor_->take(*of_lane.measurement, prediction);
  });
  done = sensible(states_->update(done, taken.data()));
  each_of(done, [&](int lane, FilterTracker& tracker, Lane& of_lane) {
    if (tracker.settle(*states_, lane, *of_lane.measurement, *taken[static_cast<std::size_t>(lane)]))
      of_lane.records = {&tracker.record_, 1};
    else
      done &= static_cast<LaneMask>(~lane_bit(lane));
  });
  // Those that go on alone take with them what was held before this step.
  each_of(static_cast<LaneMask>(waiting & ~done),
          [&](int, FilterTracker& tracker, Lane& of_lane) { of_lane.records = tracker.go_on(*of_lane.measurement); });
  if (together != 0) states_->keep(done);
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
  show(pack, lane, record_.x, record_.P);
  gate.judge(innovation.nis);
  forget_challenger();
  failed_in_row_ = 0;
  with_length(taken, [&](const auto& sized) { innovation.z = sized.z; });
  if (space_->size() < state_->size()) gain.conservativeResize(space_->size(), Eigen::NoChange);
  if (state_->mode_probabilities()) pack.mode_probabilities(lane, record_.mode_probabilities.emplace());
  record_.status = StepStatus::ok;
  passage_.used = true;
  used_time_s_ = measurement.time_s;
  return true;
}

void FilterTracker::show(const StatePack& pack, int lane, BoundedVector& x, BoundedMatrix& P) const {
  const int n = space_->size(), all = state_->size();
  x.resize(all);
  P.resize(all, all);
  pack.estimate(lane, x.data(), P.data());
  if (n == all) return;
  x.conservativeResize(n);
  P.conservativeResize(n, n);
}

void FilterTracker::come_home() const {
  if (is_in_pack_) pack_->leave(lane_, *state_);
  is_in_pack_ = false;
}

}  // namespace truebearing
