// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tracker/passive_sonar_tracker.hpp"

#include <cmath>
#include <numbers>
#include <utility>

namespace truebearing {
namespace {

constexpr std::size_t kReservedEvents = 64;  // beyond them the list allocates

// As the filter publishes it: without the frequency where its space has none.
void cut(const StepRecord& batch, const StateSpace& space, StepRecord& record) {
  record = batch;
  record.space = &space;
  const Eigen::Index n = space.size();
  if (record.x.size() <= n) return;
  record.x.conservativeResize(n);
  record.P.conservativeResize(n, n);
}

}  // namespace

PassiveSonarTracker::PassiveSonarTracker(PassiveSonarOptions options, std::unique_ptr<Tracker> batch,
                                         std::unique_ptr<Successor> filter)
    : options_(std::move(options)), batch_(std::move(batch)), filter_(std::move(filter)) {
  events_.reserve(kReservedEvents);
}

void PassiveSonarTracker::reset() {
  batch_->reset();
  filter_->reset();
  following_ = turning_ = false;
  events_.clear();
  begun_s_ = 0.0;
  events_before_ = 0;
  counts_before_ = {};
  record_ = {};
  last_.reset();
  doubtful_.reset();
}

std::unique_ptr<Tracker> PassiveSonarTracker::fresh() const {
  std::unique_ptr<Tracker> filter = filter_->fresh();
  return std::make_unique<PassiveSonarTracker>(options_, batch_->fresh(),
                                               std::unique_ptr<Successor>(dynamic_cast<Successor*>(filter.release())));
}

std::span<const StepRecord> PassiveSonarTracker::step(const Measurement& measurement) {
  return following_ ? follow(measurement) : collect(measurement);
}

TrackerCounts PassiveSonarTracker::counts() const {
  TrackerCounts sum = counts_before_;
  for (const TrackerCounts& more : {batch_->counts(), following_ ? filter_->counts() : TrackerCounts()}) {
    sum.missing += more.missing;
    sum.repeated += more.repeated;
    sum.out_of_order += more.out_of_order;
    sum.gated += more.gated;
    sum.failed += more.failed;
  }
  return sum;
}

// Only where the batch was solved at this very step, and says that it knows the range.
bool PassiveSonarTracker::is_good_enough(const StepRecord& record) const {
  constexpr double kRounding_s = 1e-6;
  if (record.status != StepStatus::ok || record.time_s < options_.hand_over_s - kRounding_s) return false;
  const Eigen::Vector2d offset_m = record.x.head<2>() - record.sensor.value_or(SensorState{}).position_m;
  const double range_m = offset_m.norm();
  const Eigen::Vector2d u = offset_m / range_m;
  const double sigma_m = std::sqrt(u.dot(record.P.topLeftCorner<2, 2>() * u));
  return 100.0 * sigma_m <= options_.hand_over_percent * range_m;
}

std::span<const StepRecord> PassiveSonarTracker::collect(const Measurement& measurement) {
  if (events_before_ > 0 && measurement.time_s < begun_s_) {  // older than the filter that was given up
    ++counts_before_.out_of_order;
    return {};
  }
  Measurement since_begun = measurement;
  since_begun.time_s -= begun_s_;
  const std::span<const StepRecord> records = batch_->step(since_begun);
  // The batch may come to another view of the past with every solution: its list replaces what it said before.
  events_.resize(events_before_);
  for (TrackEvent event : batch_->events()) {
    event.time_s += begun_s_;
    events_.push_back(event);
  }
  if (records.empty()) return {};
  const bool is_ready = is_good_enough(records.front());
  cut(records.front(), space(), record_);
  // Of a measurement that was not looked at, the time of the one before.
  record_.time_s = record_.time_s == since_begun.time_s ? measurement.time_s : record_.time_s + begun_s_;
  remember(record_);
  if (const auto now = heard(measurement)) last_ = now;
  if (is_ready) {
    filter_->take_over(record_.time_s, records.front().x, records.front().P);
    following_ = true;
    events_.push_back({TrackEvent::Kind::handed_over, record_.time_s});
  } else if (!options_.show_batch) {
    return {};
  }
  return {&record_, 1};
}

void PassiveSonarTracker::remember(const StepRecord& record) {
  plane_ = {record.x.head<4>(), record.P.topLeftCorner<4, 4>()};
  plane_s_ = record.time_s;
}

// f / (1 - v_r / c) with the last estimate carried to the measurement's time, so that neither own ship's manoeuvres nor
// the turning line of sight look like changes of the source.
std::optional<PassiveSonarTracker::Heard> PassiveSonarTracker::heard(const Measurement& measurement) const {
  const double frequency_hz = options_.sensor.value(measurement)(1);
  if (!std::isfinite(frequency_hz)) return std::nullopt;
  BearingFrequency<>::State unit;
  unit << plane_.x, 1.0;
  unit.head<2>() += (measurement.time_s - plane_s_) * plane_.x.tail<2>();
  return Heard{measurement.time_s, frequency_hz / options_.sensor.model(measurement).h(unit)(1)};
}

// A frequency that differs from the last one is either an outlier or a change. The next one tells: where it goes with
// the newcomer, the source has changed; else the newcomer is forgotten (equation 6).
PassiveSonarTracker::Source PassiveSonarTracker::watch_source(const Measurement& measurement) {
  const std::optional<Heard> now = heard(measurement);
  if (!now) return Source::steady;
  const double by_chance_hz = options_.gamma * std::numbers::sqrt2 * options_.sensor.model(measurement).sigma_hz;
  const double by_turning_hz = options_.manoeuvre_mps / options_.sensor.sound_mps * now->frequency_hz;
  const auto differs = [&](const Heard& from) {
    return std::abs(now->frequency_hz - from.frequency_hz) > by_chance_hz + by_turning_hz;
  };
  if (!last_ || !differs(*last_)) {
    last_ = now;
    doubtful_.reset();
    return Source::steady;
  }
  if (!doubtful_ || differs(*doubtful_)) {
    doubtful_ = now;
    return Source::doubtful;
  }
  last_ = now;
  return Source::changed;
}

void PassiveSonarTracker::notice_turn(const StepRecord& record) {
  if (!record.mode_probabilities) return;
  const bool turning = (*record.mode_probabilities)[0] < options_.steady_probability;
  if (turning == turning_) return;
  turning_ = turning;
  events_.push_back({turning ? TrackEvent::Kind::turn_began : TrackEvent::Kind::turn_ended, record.time_s});
}

std::span<const StepRecord> PassiveSonarTracker::filtered(const Measurement& measurement) {
  const std::span<const StepRecord> records = filter_->step(measurement);
  if (records.empty()) return records;
  notice_turn(records.front());
  remember(records.front());
  if (!filter_->is_lost()) return records;
  record_ = records.front();
  give_up(measurement.time_s);
  return {&record_, 1};
}

// The filter says nothing any more, or nothing that the next measurement goes on with. What it knew is as doubtful: a
// batch begins as the first one did.
void PassiveSonarTracker::give_up(double time_s) {
  events_.push_back({TrackEvent::Kind::given_up, time_s});
  counts_before_ = counts();
  batch_->reset();
  filter_->reset();
  following_ = turning_ = false;
  begun_s_ = time_s;
  events_before_ = events_.size();
  last_.reset();
  doubtful_.reset();
}

std::span<const StepRecord> PassiveSonarTracker::follow(const Measurement& measurement) {
  const Source source = watch_source(measurement);
  std::optional<Measurement> bearing;  // alone, where the frequency is in doubt
  if (source != Source::steady) {
    bearing = measurement;
    bearing->z[1] = std::numeric_limits<double>::quiet_NaN();
  }
  const std::span<const StepRecord> records = filtered(bearing ? *bearing : measurement);
  if (records.empty() && filter_->is_lost()) {
    give_up(measurement.time_s);
    return collect(measurement);
  }
  if (records.empty() || !following_ || source != Source::changed) return records;
  // A new source begins as one that is heard for the first time.
  record_ = records.front();
  if (const auto begun = options_.sensor.believe(plane_, measurement)) {
    filter_->take_over(measurement.time_s, begun->x, begun->P);
    events_.push_back({TrackEvent::Kind::source_changed, doubtful_->time_s, begun->x[4]});
    const Eigen::Index n = record_.x.size();
    record_.x = begun->x.head(n);
    record_.P = begun->P.topLeftCorner(n, n);
  }
  doubtful_.reset();
  return {&record_, 1};
}

}  // namespace truebearing
