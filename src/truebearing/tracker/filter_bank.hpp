// SPDX-License-Identifier: Apache-2.0
// A bank of filters under one prior each: hypotheses on what is unknown but constant (the mean of the prior, Q, R),
// weighted by the likelihood of the innovations (Magill 1965; Bar-Shalom, Li and Kirubarajan 2001, sec. 11.6.2). With
// the family's own distribution for the hypotheses its mean approximates E[x | z]: no estimator has a smaller mean
// squared error on that family, so the bank is the bound that stands beside every corrected result. Where the first
// measurement says what is to be supposed, as a bearing does of ranges (Peach 1995), the hypotheses are made from it.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "truebearing/filter/filter_group.hpp"
#include "truebearing/tracker/any_sensor.hpp"
#include "truebearing/tracker/stream_guard.hpp"
#include "truebearing/tracker/tracker.hpp"

namespace truebearing {

class FilterBank final : public Tracker {
 public:
  /// The prior of one filter of the group, and its weight.
  struct Hypothesis {
    BoundedVector x;
    BoundedMatrix P;
    double log_weight = 0.0;  ///< logarithm of its prior probability, up to a common constant
  };

  /// Sets the priors and weights of hypotheses from the first usable measurement and the latest guess that came until
  /// then. False where it cannot: the next usable measurement is then the first.
  using Supposition = std::function<bool(const Measurement&, const std::optional<TargetGuess>&, std::span<Hypothesis>)>;

  /// One hypothesis for each member of the group, whose sensors these are. They take the same measurements, what is a
  /// value to the first is one to all. The priors belong to start_time_s.
  FilterBank(const StateSpace& space, std::unique_ptr<FilterGroup> group,
             std::vector<std::unique_ptr<AnySensor>> sensors, std::vector<Hypothesis> hypotheses,
             double start_time_s = 0.0);
  /// The same with hypotheses whose priors and weights `suppose` sets.
  FilterBank(const StateSpace& space, std::unique_ptr<FilterGroup> group,
             std::vector<std::unique_ptr<AnySensor>> sensors, std::vector<Hypothesis> hypotheses, Supposition suppose);

  std::span<const StepRecord> step(const Measurement& measurement) override;
  void reset() override;
  std::unique_ptr<Tracker> fresh() const override;
  const StateSpace& space() const override { return *space_; }
  std::optional<Measured> measures() const override { return sensors_.front()->measured(); }
  TrackerCounts counts() const override { return guard_.counts; }

  // For those who look back. The members as they are at the last measurement that was used, or as the bank began.
  bool has_begun() const { return begun_; }
  bool has_used() const { return used_; }  ///< the last measurement
  double used_time_s() const { return used_time_s_; }
  const FilterGroup& filters() const { return *members_.filters; }
  std::span<const double> log_weights() const {  ///< of the heaviest 0
    return std::span(members_.log_weights).first(hypotheses_.size());
  }

 private:
  struct Members {
    std::unique_ptr<FilterGroup> filters;
    std::vector<double> log_weights;  // padded (filter_bank_kernel.hpp), of the heaviest 0
  };

  Members another() const;
  bool begin();
  std::span<const StepRecord> start_from(const Measurement& measurement);
  StepStatus predict(double dt_s);
  StepStatus weigh(const Measurement& measurement);
  void show_members();
  std::span<const StepRecord> publish(const Members& members);

  const StateSpace* space_;
  std::vector<std::unique_ptr<AnySensor>> sensors_;
  std::vector<Hypothesis> hypotheses_;
  double start_time_s_ = 0.0;
  Supposition suppose_;  // empty where the hypotheses stand beforehand
  StreamGuard guard_;
  bool begun_ = false;
  bool used_ = false;
  Members members_;  // at the last measurement that was used
  Members shown_;    // at the last step
  double used_time_s_ = 0.0;
  std::optional<TargetGuess> guess_;  // the latest since reset
  StepRecord record_;
  // Of one step.
  Prediction expected_;                       // of all members together
  std::vector<const AnyMeasurement*> taken_;  // by each sensor
  std::vector<double> gained_;
  std::vector<double> weights_;  // padded with zeros
};

}  // namespace truebearing
