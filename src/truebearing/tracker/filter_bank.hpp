// A bank of filters under one prior each: hypotheses on what is unknown but constant (the mean of the prior, Q, R),
// weighted by the likelihood of the innovations (Magill 1965; Bar-Shalom, Li and Kirubarajan 2001, sec. 11.6.2). With
// the family's own distribution for the hypotheses its mean approximates E[x | z]: no estimator has a smaller mean
// squared error on that family, so the bank is the bound that stands beside every corrected result. Where the first
// measurement says what is to be supposed, as a bearing does of ranges (Peach 1995), the hypotheses are made from it.
#pragma once

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "truebearing/tracker/stream_guard.hpp"
#include "truebearing/tracker/tracker.hpp"

namespace truebearing {

template <typename Filter, typename Motion, typename Sensor>
class FilterBank final : public Tracker {
 public:
  static constexpr int kStates = Motion::kStates;

  struct Hypothesis {
    Filter start;  ///< the prior, which belongs to time start_time_s, or to that of the first usable measurement
    Motion motion;
    Sensor sensor;
    double log_weight = 0.0;  ///< logarithm of its prior probability, up to a common constant
  };

  /// Sets the starts and weights of hypotheses from the first usable measurement and the latest guess that came until
  /// then. False where it cannot: the next usable measurement is then the first.
  using Supposition = std::function<bool(const Measurement&, const std::optional<TargetGuess>&, std::span<Hypothesis>)>;

  FilterBank(const StateSpace& space, std::vector<Hypothesis> hypotheses, double start_time_s = 0.0)
      : space_(&space), hypotheses_(std::move(hypotheses)), start_time_s_(start_time_s) {
    reset();
  }
  /// The same with hypotheses whose starts and weights `suppose` sets.
  FilterBank(const StateSpace& space, std::vector<Hypothesis> hypotheses, Supposition suppose)
      : space_(&space), hypotheses_(std::move(hypotheses)), suppose_(std::move(suppose)) {
    reset();
  }

  std::span<const StepRecord> step(const Measurement& measurement) override {
    const StreamGuard::Verdict verdict =
        guard_.examine(measurement, has_value(hypotheses_.front().sensor, measurement));
    if (verdict == StreamGuard::Verdict::repeated || verdict == StreamGuard::Verdict::out_of_order) {
      record_.status = StepStatus::rejected;
      return record_.x.size() == 0 ? std::span<const StepRecord>() : std::span<const StepRecord>(&record_, 1);
    }
    const bool usable = verdict == StreamGuard::Verdict::usable;
    if (measurement.guess) guess_ = measurement.guess;
    record_.time_s = measurement.time_s;
    record_.sensor = measurement.sensor;
    if (members_.empty()) return usable ? start_from(measurement) : std::span<const StepRecord>();

    record_.status = predict(measurement.time_s - used_time_s_);
    if (record_.status == StepStatus::coasted && usable) {
      record_.status = weigh(measurement);
      if (record_.status == StepStatus::failed) predict(measurement.time_s - used_time_s_);
    }
    if (record_.status == StepStatus::failed) ++guard_.counts.failed;
    if (record_.status == StepStatus::ok) {
      members_ = shown_;
      used_time_s_ = measurement.time_s;
    }
    publish_mixture();
    return {&record_, 1};
  }

  void reset() override {
    guard_ = {};
    record_ = {};
    record_.space = space_;
    guess_.reset();
    used_time_s_ = start_time_s_;
    members_.clear();
    if (!suppose_) begin();
  }

  std::unique_ptr<Tracker> fresh() const override {
    if (suppose_) return std::make_unique<FilterBank>(*space_, hypotheses_, suppose_);
    return std::make_unique<FilterBank>(*space_, hypotheses_, start_time_s_);
  }
  const StateSpace& space() const override { return *space_; }
  TrackerCounts counts() const override { return guard_.counts; }

 private:
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();

  struct Member {
    Filter filter;
    double log_weight;
    double weight = 0.0;  // not normalised
  };

  void begin() {
    for (const Hypothesis& hypothesis : hypotheses_) members_.push_back({hypothesis.start, hypothesis.log_weight});
  }

  std::span<const StepRecord> start_from(const Measurement& measurement) {
    if (!suppose_(measurement, guess_, hypotheses_)) return {};
    begin();
    shown_ = members_;
    used_time_s_ = measurement.time_s;
    record_.status = StepStatus::ok;
    publish_mixture();
    return {&record_, 1};
  }

  // The members at the end of a step of dt_s. They themselves stay at their last used measurement: a missing one leaves
  // no trace in what follows, to the bit.
  StepStatus predict(double dt_s) {
    shown_ = members_;
    if (!(dt_s > 0.0)) return StepStatus::coasted;
    bool valid = true;
    for (std::size_t i = 0; i < shown_.size(); ++i)
      valid &= shown_[i].filter.predict(hypotheses_[i].motion, dt_s) != StepStatus::failed;
    if (valid) return StepStatus::coasted;
    shown_ = members_;
    return StepStatus::failed;
  }

  // `failed` where no member can explain the measurement in finite numbers. One that cannot, where others can, has
  // lost.
  StepStatus weigh(const Measurement& measurement) {
    double largest = -kInfinity;
    for (std::size_t i = 0; i < shown_.size(); ++i) {
      Member& member = shown_[i];
      const auto update =
          member.filter.update(hypotheses_[i].sensor.model(measurement), hypotheses_[i].sensor.value(measurement));
      // The likelihood of the innovation, up to the power of 2 pi that all members share.
      const double gained = -0.5 * (update.nis + std::log(update.S.determinant()));
      member.log_weight += update.status == StepStatus::ok && std::isfinite(gained) ? gained : -kInfinity;
      largest = std::max(largest, member.log_weight);
    }
    if (largest == -kInfinity) return StepStatus::failed;
    for (Member& member : shown_) member.log_weight -= largest;
    return StepStatus::ok;
  }

  // x = sum w x_i, P = sum w (P_i + (x_i - x)(x_i - x)').
  void publish_mixture() {
    Eigen::Matrix<double, kStates, 1> x = Eigen::Matrix<double, kStates, 1>::Zero();
    Eigen::Matrix<double, kStates, kStates> P = Eigen::Matrix<double, kStates, kStates>::Zero();
    double largest = -kInfinity, total = 0.0;
    for (const Member& member : shown_) largest = std::max(largest, member.log_weight);
    for (Member& member : shown_) {
      member.weight = std::exp(member.log_weight - largest);
      total += member.weight;
      x += member.weight * member.filter.x();
    }
    x /= total;
    for (const Member& member : shown_) {
      if (member.weight == 0.0) continue;  // it may be so far off that its spread is not finite
      const Eigen::Matrix<double, kStates, 1> d = member.filter.x() - x;
      P += member.weight / total * (member.filter.P() + d * d.transpose());
    }
    record_.x = x;
    record_.P = P;
  }

  const StateSpace* space_;
  std::vector<Hypothesis> hypotheses_;
  double start_time_s_ = 0.0;
  Supposition suppose_;  // empty where the hypotheses stand beforehand
  StreamGuard guard_;
  std::vector<Member> members_;  // at the last measurement that was used
  std::vector<Member> shown_;    // at the last step
  double used_time_s_ = 0.0;
  std::optional<TargetGuess> guess_;  // the latest since reset
  StepRecord record_;
};

}  // namespace truebearing
