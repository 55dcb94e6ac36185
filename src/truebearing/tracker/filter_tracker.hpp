// FilterTracker makes a Tracker of a fixed-size filter, a motion model and a sensor. What the filter leaves open is
// decided here: missing, repeated, late and gated measurements, long gaps, failed arithmetic.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <type_traits>
#include <utility>
#include <variant>

#include "truebearing/measurement/longer_state.hpp"
#include "truebearing/tma/range_prior.hpp"
#include "truebearing/tracker/gate.hpp"
#include "truebearing/tracker/start.hpp"
#include "truebearing/tracker/stream_guard.hpp"
#include "truebearing/tracker/successor.hpp"
#include "truebearing/tracker/tracker.hpp"

namespace truebearing {

struct FilterTrackerOptions {
  double gate_nis = std::numeric_limits<double>::infinity();  ///< see Gate
  /// Without a usable measurement for longer than this, the target is lost: its covariance stops growing, and
  /// the next usable measurement starts a new track.
  double lost_after_s = std::numeric_limits<double>::infinity();
  /// Jitter-aware output, in [0, 1]: the published position is moved by this share of the way to the measurement,
  /// x + beta (z - x), for truth that follows what was recorded rather than what was flown. The filter itself goes on
  /// without it.
  double output_pull = 0.0;
};

/// Sensor: `Sensor::Model model(const Measurement&) const` makes the measurement model of the step, and
/// `Vector value(const Measurement&) const` what that model calls z. A filter of more components than `space` has is
/// published without the last of them.
template <typename Filter, typename Motion, typename Sensor>
class FilterTracker final : public Successor {
 public:
  static constexpr int kStates = Motion::kStates;
  static constexpr int kMeasurements = Sensor::Model::kMeasurements;
  using Prior = PriorStart<kStates>;
  /// Bearings tell no position: their tracks begin with the first of them and what is believed of the range.
  static constexpr bool kMeasuresBearings =
      requires(const Sensor& sensor, const GaussianState& plane, const Measurement& measurement) {
    sensor.start(plane, measurement);
  };
  using Start = std::conditional_t<kMeasuresBearings, std::variant<Prior, RangePrior, HandOverStart>,
                                   std::variant<Prior, TwoPointStart, OnePointStart>>;

  FilterTracker(const StateSpace& space, Motion motion, Sensor sensor, Start start, FilterTrackerOptions options = {})
      : space_(&space),
        motion_(std::move(motion)),
        sensor_(std::move(sensor)),
        start_(std::move(start)),
        options_(options) {
    reset();
  }

  std::span<const StepRecord> step(const Measurement& measurement) override {
    const StreamGuard::Verdict verdict = guard_.examine(measurement, has_value(sensor_, measurement));
    const bool usable = verdict == StreamGuard::Verdict::usable;
    if (verdict == StreamGuard::Verdict::repeated || verdict == StreamGuard::Verdict::out_of_order) return refuse();
    if constexpr (kMeasuresBearings)
      if (measurement.guess) guess_ = measurement.guess;

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
    guess_.reset();
    restart(std::holds_alternative<Prior>(start_) ? std::get<Prior>(start_).time_s : 0.0);
  }

  void take_over(double time_s, const BoundedVector& x, const BoundedMatrix& P) override {
    double rest_sigma = 0.0;
    if constexpr (kMeasuresBearings)
      if (const auto* hand_over = std::get_if<HandOverStart>(&start_)) rest_sigma = hand_over->rest_sigma;
    Prior start{State::Zero(), Covariance::Zero(), time_s};
    start.P.diagonal().setConstant(rest_sigma * rest_sigma);
    start.x.head(x.size()) = x;
    start.P.topLeftCorner(P.rows(), P.cols()) = P;
    begin(start.x, start.P);
    pending_.reset();
    filter_time_s_ = time_s;
  }

  std::unique_ptr<Tracker> fresh() const override {
    return std::make_unique<FilterTracker>(*space_, motion_, sensor_, start_, options_);
  }

  const StateSpace& space() const override { return *space_; }
  RecordBlocks blocks() const override {
    return {.prediction = true,
            .innovation = true,
            .gain = true,
            .mode_probabilities = kMultipleModel,
            .measures_position = Sensor::kMeasuresPosition};
  }
  TrackerCounts counts() const override { return guard_.counts; }

 private:
  using Vector = Eigen::Matrix<double, kMeasurements, 1>;
  using State = Eigen::Matrix<double, kStates, 1>;
  using Covariance = Eigen::Matrix<double, kStates, kStates>;
  static constexpr bool kMultipleModel = requires(const Filter& filter) { filter.mode_probabilities(); };

  void begin(const State& x, const Covariance& P) {
    if constexpr (kMultipleModel)
      filter_.emplace(x, P, motion_);
    else
      filter_.emplace(x, P);
  }

  void restart(double time_s) {
    ++record_.track;
    pending_.reset();
    filter_.reset();
    if (const auto* prior = std::get_if<Prior>(&start_)) begin(prior->x, prior->P);
    filter_time_s_ = time_s;
  }

  // Of positions, the first of two measurements waits; the second makes the state. Where both are of one time, the
  // later one waits. A bearing makes it by itself.
  std::span<const StepRecord> start_from(const Measurement& measurement) {
    if constexpr (kMeasuresBearings) {
      const auto* prior = std::get_if<RangePrior>(&start_);
      if (!prior || !prior->suffices_with(guess_)) return {};
      const auto model = sensor_.model(measurement);
      const GaussianState plane =
          prior->state(sensor_.value(measurement)[0], model.sigma_rad, {model.site_m, model.site_velocity_mps}, guess_);
      const auto start = sensor_.start(plane, measurement);
      if (!start) return {};
      return begin_from(measurement, lengthened<kStates>(start->x, start->P, 0.0));
    } else if constexpr (2 * kMeasurements <= kStates) {
      const auto R = sensor_.model(measurement).R();
      if (const auto* one_point = std::get_if<OnePointStart>(&start_)) {
        Eigen::Matrix<double, 2 * kMeasurements, 1> x = Eigen::Matrix<double, 2 * kMeasurements, 1>::Zero();
        x.template head<kMeasurements>() = sensor_.value(measurement);
        const double variance = one_point->velocity_sigma_mps * one_point->velocity_sigma_mps;
        Eigen::Matrix<double, 2 * kMeasurements, 2 * kMeasurements> P =
            variance * Eigen::Matrix<double, 2 * kMeasurements, 2 * kMeasurements>::Identity();
        P.template topLeftCorner<kMeasurements, kMeasurements>() = R;
        return begin_from(measurement, lengthened<kStates>(x, P, one_point->rest_sigma));
      }
      const auto* two_point = std::get_if<TwoPointStart>(&start_);
      if (two_point && pending_ && measurement.time_s > pending_->time_s) {
        const auto start =
            two_point_state<kMeasurements>(sensor_.value(*pending_), sensor_.model(*pending_).R(),
                                           sensor_.value(measurement), R, measurement.time_s - pending_->time_s);
        return begin_from(measurement, lengthened<kStates>(start.x, start.P, two_point->rest_sigma));
      }
    }
    pending_ = measurement;
    return {};
  }

  std::span<const StepRecord> begin_from(const Measurement& measurement, const Prior& start) {
    begin(start.x, start.P);
    pending_.reset();
    if (!filter_->x().allFinite() || !filter_->P().allFinite()) {
      ++guard_.counts.failed;
      filter_.reset();
      return {};
    }
    filter_time_s_ = measurement.time_s;
    clear_blocks();
    record_.time_s = measurement.time_s;
    record_.sensor = measurement.sensor;
    record_.status = StepStatus::ok;
    return publish(*filter_);
  }

  StepStatus predict(Filter& filter, double dt_s) {
    // A failed prediction leaves the filter where it was, which is not where it would be by now.
    if (dt_s > 0.0 && filter.predict(motion_, std::min(dt_s, options_.lost_after_s)) == StepStatus::failed) {
      ++guard_.counts.failed;
      return StepStatus::failed;
    }
    record_.prediction = Prediction{published(filter.x()), published(filter.P())};
    return StepStatus::ok;
  }

  // A model of a shorter state measures the beginning of the filter's. A multiple-model filter sees to that itself.
  template <typename Model>
  static auto use(Filter& filter, const Model& model, const Vector& z) {
    if constexpr (kMultipleModel)
      return filter.update(model, z);
    else
      return filter.update(on_state<kStates>(model), z);
  }

  // Leaves `filter` at the prediction where the measurement is not used.
  StepStatus update(Filter& filter, const Measurement& measurement) {
    Filter updated = filter;
    const auto model = sensor_.model(measurement);
    const Vector z = sensor_.value(measurement);
    const auto update = use(updated, model, z);
    if (update.status == StepStatus::failed || !std::isfinite(update.nis)) {  // so far off that its square overflows
      ++guard_.counts.failed;
      return StepStatus::failed;
    }
    record_.innovation = Innovation{z, update.nu, update.S, update.nis};
    if (!gate_.passes(update.nis)) {
      ++guard_.counts.gated;
      return StepStatus::rejected;
    }
    if (space_->size() == kStates)
      record_.gain.emplace(update.K);
    else
      record_.gain.emplace(update.K.topRows(space_->size()));
    filter = updated;
    if (options_.output_pull > 0.0) pull(model, z, update, filter);
    return StepStatus::ok;
  }

  // A measurement that was not looked at: the state of the step before stands.
  std::span<const StepRecord> refuse() {
    if (!filter_ || record_.x.size() == 0) return {};
    clear_blocks();
    record_.status = StepStatus::rejected;
    return {&record_, 1};
  }

  // With the gain K' = K + beta G (I - H K), G = [I; 0], in place of K: the covariance grows by (K' - K) S (K' - K)'.
  template <typename Model, typename UpdateType>
  void pull(const Model& model, const Vector& z, const UpdateType& update, const Filter& filter) {
    constexpr int n = Model::kStates;
    const Eigen::Matrix<double, n, 1> x = filter.x().template head<n>();
    const Eigen::Matrix<double, kMeasurements, kMeasurements> left =
        decltype(update.S)::Identity() - model.H(x) * update.K.template topRows<n>();
    moved_ = options_.output_pull * model.residual(z, model.h(x));
    spread_ = options_.output_pull * options_.output_pull * left * update.S * left.transpose();
  }

  std::span<const StepRecord> publish(const Filter& filter) {
    record_.x = published(filter.x());
    record_.P = published(filter.P());
    if (options_.output_pull > 0.0 && record_.gain) {
      record_.x.template head<kMeasurements>() += moved_;
      record_.P.template topLeftCorner<kMeasurements, kMeasurements>() += spread_;
    }
    if constexpr (kMultipleModel) record_.mode_probabilities = filter.mode_probabilities();
    return {&record_, 1};
  }

  // Without the components that the space does not have; whole, and so without a loop, where it has them all.
  BoundedVector published(const State& x) const {
    if (space_->size() == kStates) return x;
    return x.head(space_->size());
  }
  BoundedMatrix published(const Covariance& P) const {
    if (space_->size() == kStates) return P;
    return P.topLeftCorner(space_->size(), space_->size());
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
  std::optional<TargetGuess> guess_;  // the latest since reset, of a tracker of bearings
  StepRecord record_;
  Vector moved_ = Vector::Zero();  // of the last step's output_pull
  Eigen::Matrix<double, kMeasurements, kMeasurements> spread_ =
      Eigen::Matrix<double, kMeasurements, kMeasurements>::Zero();
};

}  // namespace truebearing
