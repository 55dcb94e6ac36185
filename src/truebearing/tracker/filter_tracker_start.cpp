// SPDX-License-Identifier: Apache-2.0
// How a FilterTracker begins a track: by the kinds of Start, from one measurement or two; and how measurements that its
// gate turns away begin another.
#include <optional>
#include <variant>

#include "truebearing/tracker/filter_tracker.hpp"

namespace truebearing {

// Of positions, the first of two measurements waits; the second makes the state. Where both are of one time, the later
// one waits. A bearing makes it by itself.
std::span<const StepRecord> FilterTracker::start_from(const Measurement& measurement) {
  const std::optional<PriorStart> start = start_at(pending_, measurement);
  if (!start) {
    if (sensor_->fix(measurement)) pending_ = measurement;
    return {};
  }
  begin(*start);
  pending_.reset();
  clear_blocks();
  record_.status = StepStatus::ok;
  if (!publish()) {
    ++guard_.counts.failed;
    begun_ = false;
    return {};
  }
  passage_.used = passage_.begins = true;
  used_time_s_ = measurement.time_s;
  record_.time_s = measurement.time_s;
  record_.sensor = measurement.sensor;
  record_.source = measurement.source;
  return {&record_, 1};
}

// The state that a measurement begins, with the one before it where it needs two. Nothing where that is not there, or
// so long ago that the target would be lost, or where measurements, or that sensor's, begin no track.
std::optional<PriorStart> FilterTracker::start_at(const std::optional<Measurement>& waiting,
                                                  const Measurement& measurement) {
  const int n = state_->size();
  if (const auto* prior = std::get_if<RangePrior>(&start_)) {
    if (!prior->suffices_with(guess_)) return {};
    const std::optional<Sight> sight = sensor_->sight(measurement);
    if (!sight) return {};
    const GaussianState plane = prior->state(sight->bearing_rad, sight->sigma_rad, sight->from, guess_);
    const std::optional<PriorStart> start = sensor_->believe(plane, measurement);
    return start ? std::optional(lengthened(with_climb(*start, prior->climb_sigma_mps), n, 0.0)) : std::nullopt;
  }
  const std::optional<PositionFix> fix = sensor_->fix(measurement);
  if (!fix) return {};
  if (const auto* one_point = std::get_if<OnePointStart>(&start_))
    return lengthened(one_point_state(*fix, *one_point), n, one_point->rest_sigma);
  const auto* two_point = std::get_if<TwoPointStart>(&start_);
  const double dt_s = waiting ? measurement.time_s - waiting->time_s : 0.0;
  if (!two_point || !(dt_s > 0.0) || dt_s > options_.lost_after_s) return {};
  const std::optional<PositionFix> first = sensor_->fix(*waiting);
  if (!first) return {};
  PriorStart start = lengthened(two_point_state(*first, *fix, dt_s), n, two_point->rest_sigma);
  add_motion(dt_s, start);
  return start;
}

// What the target may have done between two points, of which the line through them knows nothing: with Q of its motion
// over dt, the error of (z2 - z1) / dt as its velocity now grows by [1/dt, -1] Q [1/dt, -1]'.
void FilterTracker::add_motion(double dt_s, PriorStart& start) {
  constexpr double kNearlyNothing = 1e-12;  // filters in other forms than P want it to be positive
  const int n = state_->size(), d = space_->size() / 2;
  const BoundedMatrix P = kNearlyNothing * BoundedMatrix::Identity(n, n);
  challenger_->begin(start.x.data(), P.data());
  if (challenger_->predict(dt_s) == StepStatus::failed) return;
  const BoundedMatrix Q = challenger_->P();
  start.P.block(d, d, d, d) +=
      Q.block(d, d, d, d) - (Q.block(0, d, d, d) + Q.block(d, 0, d, d)) / dt_s + Q.block(0, 0, d, d) / (dt_s * dt_s);
}

// Measurements that the gate turns away one after another, and that agree with each other, are the target: then it was
// the track that was wrong. True where a start of their own takes over.
bool FilterTracker::challenge(const Measurement& measurement, double nis) {
  constexpr int kAgreeing = 3;
  const int first = std::holds_alternative<TwoPointStart>(start_) ? 2 : 1;  // agreeing ones that make a challenger
  StateUpdate update;
  const auto challenger_takes = [&] {
    const Prediction expected{challenger_->x(), challenger_->P()};
    return challenger_->update(sensor_->take(measurement, expected), update) == StepStatus::ok;
  };
  if (agreeing_ >= first && cross(measurement.time_s - challenger_time_s_, *challenger_) == StepStatus::ok &&
      challenger_takes() && update.nis <= gate_of(measurement).threshold()) {
    ++agreeing_;
  } else if (const std::optional<PriorStart> start = start_at(turned_away_, measurement)) {
    challenger_->begin(start->x.data(), start->P.data());
    agreeing_ = first;
  } else if (first == 1) {
    // Measurements begin no track: what was predicted, with the covariance that lets this one pass.
    challenger_->assign(*state_);
    widen(*challenger_, nis / gate_of(measurement).threshold());
    agreeing_ = challenger_takes() ? 1 : 0;
  } else {
    agreeing_ = 1;  // the first of two points
  }
  challenger_time_s_ = measurement.time_s;
  turned_away_ = measurement;
  return agreeing_ >= kAgreeing;
}

}  // namespace truebearing
