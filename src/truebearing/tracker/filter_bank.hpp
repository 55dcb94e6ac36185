// A bank of filters under one prior each: hypotheses on what is unknown but constant (the mean of the prior, Q, R), weighted by
// the likelihood of the innovations (Magill 1965; Bar-Shalom, Li and Kirubarajan 2001, sec. 11.6.2). With the family's own
// distribution for the hypotheses its mean approximates E[x | z]: no estimator has a smaller mean squared error on that
// family, so the bank is the bound that stands beside every corrected result.
#pragma once

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "truebearing/tracker/stream_guard.hpp"
#include "truebearing/tracker/tracker.hpp"

namespace truebearing {

template <typename Filter, typename Motion, typename Sensor>
class FilterBank final : public Tracker {
 public:
  static constexpr int kStates = Motion::kStates;
  static constexpr int kMeasurements = Sensor::Model::kMeasurements;

  struct Hypothesis {
    Filter start;  ///< the prior, which belongs to time start_time_s
    Motion motion;
    Sensor sensor;
    double log_weight = 0.0;  ///< logarithm of its prior probability, up to a common constant
  };

  FilterBank(const StateSpace& space, std::vector<Hypothesis> hypotheses, double start_time_s = 0.0)
      : space_(&space), hypotheses_(std::move(hypotheses)), start_time_s_(start_time_s) {
    reset();
  }

  std::span<const StepRecord> step(const Measurement& measurement) override {
    const StreamGuard::Verdict verdict = guard_.examine(measurement);
    if (verdict == StreamGuard::Verdict::repeated || verdict == StreamGuard::Verdict::out_of_order) {
      record_.status = StepStatus::rejected;
      return record_.x.size() == 0 ? std::span<const StepRecord>() : std::span<const StepRecord>(&record_, 1);
    }
    const bool usable = verdict == StreamGuard::Verdict::usable && measurement.z.size() == kMeasurements;
    const double dt_s = measurement.time_s - time_s_;
    time_s_ = measurement.time_s;
    record_.time_s = time_s_;
    record_.sensor = measurement.sensor;
    record_.status = usable ? StepStatus::ok : StepStatus::coasted;
    for (std::size_t i = 0; i < members_.size(); ++i) {
      members_[i].filter.predict(hypotheses_[i].motion, dt_s);
      if (usable) weigh(members_[i], hypotheses_[i].sensor, measurement);
    }
    publish_mixture();
    return {&record_, 1};
  }

  void reset() override {
    guard_ = {};
    record_ = {};
    record_.space = space_;
    time_s_ = start_time_s_;
    members_.clear();
    for (const Hypothesis& hypothesis : hypotheses_) members_.push_back({hypothesis.start, hypothesis.log_weight, 0.0});
  }

  std::unique_ptr<Tracker> clone() const override {
    return std::make_unique<FilterBank>(*space_, hypotheses_, start_time_s_);
  }
  const StateSpace& space() const override { return *space_; }
  TrackerCounts counts() const override { return guard_.counts; }

 private:
  struct Member {
    Filter filter;
    double log_weight;
    double weight = 0.0;
  };

  // The likelihood of the innovation, up to the power of 2 pi that all members share.
  static void weigh(Member& member, const Sensor& sensor, const Measurement& measurement) {
    const auto update = member.filter.update(sensor.model(measurement), measurement.z);
    if (update.status == StepStatus::ok) member.log_weight -= 0.5 * (update.nis + std::log(update.S.determinant()));
  }

  // x = sum w x_i, P = sum w (P_i + (x_i - x)(x_i - x)').
  void publish_mixture() {
    double largest = -std::numeric_limits<double>::infinity();
    for (const Member& member : members_) largest = std::max(largest, member.log_weight);
    Eigen::Matrix<double, kStates, 1> x = Eigen::Matrix<double, kStates, 1>::Zero();
    Eigen::Matrix<double, kStates, kStates> P = Eigen::Matrix<double, kStates, kStates>::Zero();
    double total = 0.0;
    for (Member& member : members_) {
      member.log_weight -= largest;
      member.weight = std::exp(member.log_weight);
      total += member.weight;
      x += member.weight * member.filter.x();
    }
    x /= total;
    for (const Member& member : members_) {
      const Eigen::Matrix<double, kStates, 1> d = member.filter.x() - x;
      P += member.weight / total * (member.filter.P() + d * d.transpose());
    }
    record_.x = x;
    record_.P = P;
  }

  const StateSpace* space_;
  std::vector<Hypothesis> hypotheses_;
  double start_time_s_;
  StreamGuard guard_;
  std::vector<Member> members_;
  double time_s_ = 0.0;
  StepRecord record_;
};

}  // namespace truebearing
