// FilterTracker makes a Tracker of a fixed-size filter, a motion model and a sensor. What the filter leaves open is
// decided here: missing, repeated, late and gated measurements, long gaps, failed arithmetic.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <variant>

#include "truebearing/tracker/gate.hpp"
#include "truebearing/tracker/start.hpp"
#include "truebearing/tracker/stream_guard.hpp"
#include "truebearing/tracker/tracker.hpp"

namespace truebearing {

struct FilterTrackerOptions {
  double gate_nis = std::numeric_limits<double>::infinity();  ///< see Gate
  /// Without a usable measurement for longer than this, the target is lost: its covariance stops growing, and
  /// the next usable measurement starts a new track.
  double lost_after_s = std::numeric_limits<double>::infinity();
};

/// Sensor: `Sensor::Model model(const Measurement&) const` makes the measurement model of the step.
template <typename Filter, typename Motion, typename Sensor>
class FilterTracker final : public Tracker {
 public:
  static constexpr int kStates = Motion::kStates;
  static constexpr int kMeasurements = Sensor::Model::kMeasurements;
  using Prior = PriorStart<kStates>;
  using Start = std::variant<Prior, TwoPointStart>;

  FilterTracker(const StateSpace& space, Motion motion, Sensor sensor, Start start, FilterTrackerOptions options = {})
      : space_(&space),
        motion_(std::move(motion)),
        sensor_(std::move(sensor)),
        start_(std::move(start)),
        options_(options) {
    reset();
  }

  std::span<const StepRecord> step(const Measurement& measurement) override {
    const StreamGuard::Verdict verdict = guard_.examine(measurement);
    const bool usable = verdict == StreamGuard::Verdict::usable && measurement.z.size() == kMeasurements;
    if (verdict == StreamGuard::Verdict::repeated || verdict == StreamGuard::Verdict::out_of_order) return refuse();

    if (usable && filter_ && measurement.time_s - filter_time_s_ > options_.lost_after_s) restart(measurement.time_s);
    if (!filter_) return usable ? start_from(measurement) : std::span<const StepRecord>();

    clear_blocks();
    record_.time_s = measurement.time_s;
    record_.sensor = measurement.sensor;

    // The filter stays at its last used measurement: a missing one leaves no trace in what follows, to the bit.
    Filter filter = *filter_;
    record_.status = predict(filter, measurement.time_s - filter_time_s_);
    if (record_.status == StepStatus::ok) record_.status = usable ? update(filter, measurement) : StepStatus::coasted;
    if (record_.status == StepStatus::ok) {
      *filter_ = filter;
      filter_time_s_ = measurement.time_s;
    }
    return publish(filter);
  }

  void reset() override {
    guard_ = {};
    gate_ = Gate(options_.gate_nis);
    record_ = {};
    record_.space = space_;
    record_.track = -1;
    restart(std::holds_alternative<Prior>(start_) ? std::get<Prior>(start_).time_s : 0.0);
  }

  std::unique_ptr<Tracker> clone() const override {
    return std::make_unique<FilterTracker>(*space_, motion_, sensor_, start_, options_);
  }

  const StateSpace& space() const override { return *space_; }
  RecordBlocks blocks() const override { return {.prediction = true, .innovation = true, .gain = true}; }
  TrackerCounts counts() const override { return guard_.counts; }

 private:
  using Vector = Eigen::Matrix<double, kMeasurements, 1>;

  void restart(double time_s) {
    ++record_.track;
    pending_.reset();
    filter_.reset();
    if (const auto* prior = std::get_if<Prior>(&start_)) filter_.emplace(prior->x, prior->P);
    filter_time_s_ = time_s;
  }

  // The first of two measurements waits; the second makes the state. Where both are of one time, the later one waits.
  std::span<const StepRecord> start_from(const Measurement& measurement) {
    if constexpr (2 * kMeasurements == kStates) {
      if (pending_ && measurement.time_s > pending_->time_s) {
        const auto start =
            two_point_state<kMeasurements>(Vector(pending_->z), sensor_.model(*pending_).R(), Vector(measurement.z),
                                           sensor_.model(measurement).R(), measurement.time_s - pending_->time_s);
        filter_.emplace(start.x, start.P);
        pending_.reset();
        filter_time_s_ = measurement.time_s;
        clear_blocks();
        record_.time_s = measurement.time_s;
        record_.sensor = measurement.sensor;
        record_.status = StepStatus::ok;
        return publish(*filter_);
      }
    }
    pending_ = measurement;
    return {};
  }

  StepStatus predict(Filter& filter, double dt_s) {
    // A failed prediction leaves the filter where it was, which is not where it would be by now.
    if (dt_s > 0.0 && filter.predict(motion_, std::min(dt_s, options_.lost_after_s)) == StepStatus::failed) {
      ++guard_.counts.failed;
      return StepStatus::failed;
    }
    record_.prediction = Prediction{filter.x(), filter.P()};
    return StepStatus::ok;
  }

  // Leaves `filter` at the prediction where the measurement is not used.
  StepStatus update(Filter& filter, const Measurement& measurement) {
    Filter updated = filter;
    const auto update = updated.update(sensor_.model(measurement), Vector(measurement.z));
    if (update.status == StepStatus::failed || !std::isfinite(update.nis)) {  // so far off that its square overflows
      ++guard_.counts.failed;
      return StepStatus::failed;
    }
    record_.innovation = Innovation{measurement.z, update.nu, update.S, update.nis};
    if (!gate_.passes(update.nis)) {
      ++guard_.counts.gated;
      return StepStatus::rejected;
    }
    record_.gain.emplace(update.K);
    filter = updated;
    return StepStatus::ok;
  }

  // A measurement that was not looked at: the state of the step before stands.
  std::span<const StepRecord> refuse() {
    if (!filter_ || record_.x.size() == 0) return {};
    clear_blocks();
    record_.status = StepStatus::rejected;
    return {&record_, 1};
  }

  std::span<const StepRecord> publish(const Filter& filter) {
    record_.x = filter.x();
    record_.P = filter.P();
    return {&record_, 1};
  }

  void clear_blocks() {
    record_.prediction.reset();
    record_.innovation.reset();
    record_.gain.reset();
  }

  const StateSpace* space_;
  Motion motion_;
  Sensor sensor_;
  Start start_;
  FilterTrackerOptions options_;

  StreamGuard guard_;
  Gate gate_;
  std::optional<Filter> filter_;
  double filter_time_s_ = 0.0;  // of the last measurement that was used
  std::optional<Measurement> pending_;
  StepRecord record_;
};

}  // namespace truebearing
