// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tracker/filter_bank.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "truebearing/core/constants.hpp"
#include "truebearing/core/simd_width.hpp"
#include "truebearing/tracker/filter_bank_kernel.hpp"
#include "truebearing/tracker/publishable.hpp"

namespace truebearing {

FilterBank::FilterBank(const StateSpace& space, std::unique_ptr<FilterGroup> group,
                       std::vector<std::unique_ptr<AnySensor>> sensors, std::vector<Hypothesis> hypotheses,
                       double start_time_s)
    : FilterBank(space, std::move(group), std::move(sensors), std::move(hypotheses), Supposition()) {
  start_time_s_ = start_time_s;
  reset();
}

FilterBank::FilterBank(const StateSpace& space, std::unique_ptr<FilterGroup> group,
                       std::vector<std::unique_ptr<AnySensor>> sensors, std::vector<Hypothesis> hypotheses,
                       Supposition suppose)
    : space_(&space),
      sensors_(std::move(sensors)),
      hypotheses_(std::move(hypotheses)),
      suppose_(std::move(suppose)),
      taken_(sensors_.size()),
      gained_(static_cast<std::size_t>(padded_to_widest(static_cast<int>(hypotheses_.size())))),
      weights_(gained_.size()) {
  if (hypotheses_.empty() || !group || group->size() != hypotheses_.size() || space.size() > group->states())
    throw std::invalid_argument("a bank has a filter for each hypothesis, of states as long as its space");
  members_ = {std::move(group), std::vector<double>(gained_.size(), -kInfinity)};
  shown_ = another();
  reset();
}

FilterBank::Members FilterBank::another() const {
  return {members_.filters->fresh(), members_.log_weights};
}

std::span<const StepRecord> FilterBank::step(const Measurement& measurement) {
  used_ = false;
  const StreamGuard::Verdict verdict = guard_.examine(measurement, sensors_.front()->has_value(measurement));
  if (verdict == StreamGuard::Verdict::repeated || verdict == StreamGuard::Verdict::out_of_order) {
    set_status(StepStatus::rejected, record_);
    return record_.x.size() == 0 ? std::span<const StepRecord>() : std::span<const StepRecord>(&record_, 1);
  }
  const bool usable = verdict == StreamGuard::Verdict::usable;
  if (measurement.guess) guess_ = measurement.guess;
  record_.time_s = measurement.time_s;
  record_.sensor = measurement.sensor;
  if (!begun_) return usable ? start_from(measurement) : std::span<const StepRecord>();

  record_.status = predict(measurement.time_s - used_time_s_);
  if (record_.status == StepStatus::coasted && usable) {
    record_.status = weigh(measurement);
    if (record_.status == StepStatus::failed) predict(measurement.time_s - used_time_s_);
  }
  if (record_.status == StepStatus::failed) ++guard_.counts.failed;
  if (record_.status != StepStatus::ok) return publish(shown_);
  std::swap(members_, shown_);
  used_ = true;
  used_time_s_ = measurement.time_s;
  return publish(members_);
}

void FilterBank::reset() {
  guard_ = {};
  record_ = {};
  record_.space = space_;
  guess_.reset();
  used_time_s_ = start_time_s_;
  begun_ = used_ = false;
  if (suppose_) return;
  begin();
  begun_ = true;
}

std::unique_ptr<Tracker> FilterBank::fresh() const {
  std::vector<std::unique_ptr<AnySensor>> sensors;
  for (const auto& sensor : sensors_) sensors.push_back(sensor->fresh());
  if (suppose_)
    return std::make_unique<FilterBank>(*space_, members_.filters->fresh(), std::move(sensors), hypotheses_, suppose_);
  return std::make_unique<FilterBank>(*space_, members_.filters->fresh(), std::move(sensors), hypotheses_,
                                      start_time_s_);
}

bool FilterBank::begin() {
  bool valid = true;
  for (std::size_t i = 0; i < hypotheses_.size(); ++i) {
    valid &= members_.filters->begin(i, hypotheses_[i].x.data(), hypotheses_[i].P.data());
    members_.log_weights[i] = hypotheses_[i].log_weight;
  }
  std::fill(gained_.begin(), gained_.end(), 0.0);
  return kernels::gain_weights(gained_.data(), gained_.size(), members_.log_weights.data()) && valid;
}

std::span<const StepRecord> FilterBank::start_from(const Measurement& measurement) {
  if (!suppose_(measurement, guess_, hypotheses_) || !begin()) return {};
  begun_ = used_ = true;
  used_time_s_ = measurement.time_s;
  record_.status = StepStatus::ok;
  return publish(members_);
}

void FilterBank::show_members() {
  shown_.filters->assign(*members_.filters);
  shown_.log_weights = members_.log_weights;
}

// The members at the end of a step of dt_s. They themselves stay at their last used measurement: a missing one leaves
// no trace in what follows, to the bit.
StepStatus FilterBank::predict(double dt_s) {
  show_members();
  if (!(dt_s > 0.0) || shown_.filters->predict(dt_s)) return StepStatus::coasted;
  show_members();
  return StepStatus::failed;
}

// `failed` where no member can explain the measurement in finite numbers. One that cannot, where others can, has lost.
StepStatus FilterBank::weigh(const Measurement& measurement) {
  if (sensors_.front()->heeds_expected()) {
    publish(shown_);
    expected_ = {record_.x, record_.P};
  }
  for (std::size_t s = 0; s < sensors_.size(); ++s) taken_[s] = &sensors_[s]->take(measurement, expected_);
  shown_.filters->update(taken_, gained_);
  return kernels::gain_weights(gained_.data(), gained_.size(), shown_.log_weights.data()) ? StepStatus::ok
                                                                                          : StepStatus::failed;
}

std::span<const StepRecord> FilterBank::publish(const Members& members) {
  const double total = kernels::weights_of(members.log_weights.data(), weights_.size(), weights_.data());
  members.filters->mix(weights_, total, record_.x, record_.P);
  if (const int n = space_->size(); n < record_.x.size()) {  // without the components that the space does not have
    record_.x.conservativeResize(n);
    record_.P.conservativeResize(n, n);
  }
  set_status(record_.status, record_);
  return {&record_, 1};
}

}  // namespace truebearing
