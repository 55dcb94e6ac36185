// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tracker/filter_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "truebearing/core/unfilled.hpp"

namespace truebearing {
namespace {

// Updates that fail one after another, until the track is given up.
constexpr int kFailedInRow = 3;

}  // namespace

FilterTracker::FilterTracker(const StateSpace& space, std::unique_ptr<TrackedState> state,
                             std::unique_ptr<AnySensor> sensor, Start start, FilterTrackerOptions options)
    : space_(&space),
      sensor_(std::move(sensor)),
      start_(std::move(start)),
      options_(options),
      state_(std::move(state)),
      kept_(state_->fresh()),
      published_(space.size()),
      copy_(copy_of(state_->size(), published_)),
      ahead_(options_.ahead_s > 0.0 ? state_->fresh() : nullptr),
      challenger_(state_->fresh()) {
  check();
  reset();
}

void FilterTracker::check() const {
  const auto* prior = std::get_if<PriorStart>(&start_);
  if (prior && (prior->x.size() != state_->size() || prior->P.rows() != state_->size()))
    throw std::invalid_argument("a prior has as many components as the state");
  if ((std::holds_alternative<OnePointStart>(start_) || std::holds_alternative<TwoPointStart>(start_)) &&
      !sensor_->tells_position())
    throw std::invalid_argument("a start from measurements needs measured positions");
  if (std::holds_alternative<RangePrior>(start_) && !sensor_->tells_bearing())
    throw std::invalid_argument("a start from a range needs measured bearings");
  if (options_.output_pull > 0.0 && !sensor_->measures_position())
    throw std::invalid_argument("output_pull needs measured positions");
  if (options_.output_pull > 0.0 && options_.ahead_s > 0.0)
    throw std::invalid_argument("output_pull is of the present");
  if (!options_.gate_nis_of.empty() && options_.gate_nis_of.size() != sensor_->measured().sources.size())
    throw std::invalid_argument("there is a gate for each of several sensors");
  if (space_->size() > state_->size() || sensor_->states() > state_->size())
    throw std::invalid_argument("the state is shorter than its space, or than what the sensor looks at");
}

std::span<const StepRecord> FilterTracker::step(const Measurement& measurement) {
  const auto records = open(measurement);
  return records ? *records : go_on(measurement);
}

// What comes before the filter. The records, where the step ends with that.
std::optional<std::span<const StepRecord>> FilterTracker::open(const Measurement& measurement) {
  passage_ = {};
  const StreamGuard::Verdict verdict = guard_.examine(measurement, sensor_->has_value(measurement));
  usable_ = verdict == StreamGuard::Verdict::usable;
  if (verdict == StreamGuard::Verdict::repeated || verdict == StreamGuard::Verdict::out_of_order) return refuse();
  if (measurement.guess) guess_ = measurement.guess;

  if (usable_ && begun_ && (lost_ || measurement.time_s - used_time_s_ > options_.lost_after_s))
    restart(measurement.time_s);
  if (!begun_) return usable_ ? start_from(measurement) : std::span<const StepRecord>();
  return std::nullopt;
}

std::span<const StepRecord> FilterTracker::go_on(const Measurement& measurement) {
  fetch_state();
  begin_record(measurement);
  // The filter stays at its last used measurement: a missing one leaves no trace in what follows, to the bit.
  kept_->assign(*state_);
  if (!predict(measurement.time_s - used_time_s_)) {  // so long ago that nothing is known any more
    if (!usable_) return give_up();
    restart(measurement.time_s);
    if (!begun_) return start_from(measurement);
    kept_->assign(*state_);
    predict(0.0);
  }
  if (record_.status == StepStatus::ok) record_.status = usable_ ? update(measurement) : StepStatus::coasted;
  const bool used = record_.status == StepStatus::ok;  // whether or not what is ahead can be told
  if (!publish()) {
    lost_ = true;
    return give_up();
  }
  passage_.used = used;
  if (used)
    used_time_s_ = measurement.time_s;
  else
    state_.swap(kept_);
  return {&record_, 1};
}

void FilterTracker::begin_record(const Measurement& measurement) {
  clear_blocks();
  record_.time_s = measurement.time_s;
  record_.sensor = measurement.sensor;
  record_.source = measurement.source;
}

void FilterTracker::reset() {
  guard_ = {};
  record_ = {};
  record_.space = space_;
  record_.track = -1;
  guess_.reset();
  const auto* prior = std::get_if<PriorStart>(&start_);
  restart(prior ? prior->time_s : 0.0);
}

void FilterTracker::take_over(double time_s, const BoundedVector& x, const BoundedMatrix& P) {
  const auto* hand_over = std::get_if<HandOverStart>(&start_);
  forget();
  begin(lengthened({x, P}, state_->size(), hand_over ? hand_over->rest_sigma : 0.0));
  used_time_s_ = time_s;
}

std::unique_ptr<Tracker> FilterTracker::fresh() const {
  return std::make_unique<FilterTracker>(*space_, state_->fresh(), sensor_->fresh(), start_, options_);
}

bool FilterTracker::assign(const Tracker& tracker) {
  const auto* other = dynamic_cast<const FilterTracker*>(&tracker);
  if (!other) return false;
  guard_ = other->guard_;
  gates_ = other->gates_;
  begun_ = other->begun_;
  if (other != this) place_.drop();
  state_->assign(other->state());
  used_time_s_ = other->used_time_s_;
  passage_ = other->passage_;
  lost_ = other->lost_;
  failed_in_row_ = other->failed_in_row_;
  challenger_->assign(*other->challenger_);
  challenger_time_s_ = other->challenger_time_s_;
  agreeing_ = other->agreeing_;
  turned_away_ = other->turned_away_;
  pending_ = other->pending_;
  guess_ = other->guess_;
  record_ = other->record_;
  return true;
}

RecordBlocks FilterTracker::blocks() const {
  return {.prediction = true,
          .innovation = true,
          .gain = true,
          .mode_probabilities = state_->mode_probabilities() != nullptr,
          .measures_position = sensor_->measures_position()};
}

void FilterTracker::begin(const PriorStart& start) {
  state_->begin(start.x.data(), start.P.data());
  place_.drop();
  begun_ = true;
}

void FilterTracker::restart(double time_s) {
  ++record_.track;
  passage_.begins = true;
  forget();
  begun_ = false;
  place_.drop();
  if (const auto* prior = std::get_if<PriorStart>(&start_)) begin(*prior);
  used_time_s_ = time_s;
}

// What came before a state that begins anew.
void FilterTracker::forget() {
  pending_.reset();
  gates_.clear();
  for (const double gate_nis : options_.gate_nis_of) gates_.emplace_back(gate_nis);
  if (gates_.empty()) gates_.emplace_back(options_.gate_nis);
  lost_ = false;
  failed_in_row_ = 0;
  forget_challenger();
}

void FilterTracker::forget_challenger() {
  turned_away_.reset();
  agreeing_ = 0;
}

// As wide as lets a measurement pass: P times `factor`.
void FilterTracker::widen(TrackedState& state, double factor) {
  const BoundedVector x = state.x();
  const BoundedMatrix P = factor * state.P();
  state.begin(x.data(), P.data());
}

StepStatus FilterTracker::cross(double dt_s, TrackedState& state) const {
  return dt_s > 0.0 ? state.predict(std::min(dt_s, options_.lost_after_s)) : StepStatus::ok;
}

// Gives the record its prediction and, until there is an update, its status. False where what came out is no track.
bool FilterTracker::predict(double dt_s) {
  record_.status = cross(dt_s, *state_);
  Prediction& prediction = record_.prediction.emplace(Unfilled());
  const bool sensible = copy_published(*state_, prediction.x, prediction.P);
  // A failed prediction leaves the filter where it was, which is not where it would be by now.
  if (record_.status == StepStatus::failed) {
    ++guard_.counts.failed;
    record_.prediction.reset();
  }
  return sensible;
}

// Leaves the state at the prediction where the measurement is not used.
StepStatus FilterTracker::update(const Measurement& measurement) {
  const auto predict_again = [&] {
    state_->assign(*kept_);
    cross(measurement.time_s - used_time_s_, *state_);
  };
  const AnyMeasurement& taken = sensor_->take(measurement, *record_.prediction);
  Innovation& innovation = record_.innovation.emplace(Unfilled());
  BoundedMatrix& gain = record_.gain.emplace();
  const StepStatus status = state_->update(taken, {innovation.nu, innovation.S, gain, innovation.nis});
  if (status == StepStatus::failed || !std::isfinite(innovation.nis)) {  // so far off that its square overflows
    ++guard_.counts.failed;
    lost_ = ++failed_in_row_ >= kFailedInRow;
    record_.innovation.reset();
    record_.gain.reset();
    predict_again();
    return StepStatus::failed;
  }
  with_length(taken, [&](const auto& sized) { innovation.z = sized.z; });
  failed_in_row_ = 0;
  Gate& gate = gate_of(measurement);
  switch (gate.judge(innovation.nis)) {
    case Gate::Verdict::passes:
      forget_challenger();
      break;
    case Gate::Verdict::passes_widened:
      predict_again();
      passage_.widened = innovation.nis / gate.threshold();
      widen(*state_, passage_.widened);
      forget_challenger();
      if (state_->update(taken, {innovation.nu, innovation.S, gain, innovation.nis}) == StepStatus::failed) {
        predict_again();
        return StepStatus::rejected;
      }
      break;
    case Gate::Verdict::rejected: {
      predict_again();
      const bool takes_over = challenge(measurement, innovation.nis);
      record_.gain.reset();
      if (!takes_over) {
        ++guard_.counts.gated;
        return StepStatus::rejected;
      }
      record_.innovation.reset();
      state_.swap(challenger_);
      forget();
      passage_.begins = true;
      return StepStatus::ok;
    }
  }
  if (options_.output_pull > 0.0) pull(taken);
  if (published_ < state_->size()) gain.conservativeResize(published_, Eigen::NoChange);
  return StepStatus::ok;
}

// A sensor that goes wrong opens no gate but its own.
Gate& FilterTracker::gate_of(const Measurement& measurement) {
  return gates_.size() == 1 ? gates_.front() : gates_[static_cast<std::size_t>(measurement.source)];
}

// What came out is no track any more: the last one that was stands in the record.
std::span<const StepRecord> FilterTracker::give_up() {
  ++guard_.counts.failed;
  record_.status = StepStatus::failed;
  clear_blocks();
  state_.swap(kept_);
  publish();
  return {&record_, 1};
}

// A measurement that was not looked at: the state of the step before stands.
std::span<const StepRecord> FilterTracker::refuse() {
  if (!begun_ || record_.x.size() == 0) return {};
  clear_blocks();
  record_.status = StepStatus::rejected;
  return {&record_, 1};
}

void FilterTracker::clear_blocks() {
  record_.prediction.reset();
  record_.innovation.reset();
  record_.gain.reset();
}

}  // namespace truebearing
