// SPDX-License-Identifier: Apache-2.0
// CorrectedTracker: an ensemble and a correction of it, which together are a Tracker like any other.
#pragma once

#include <memory>

#include "truebearing/correction/correction.hpp"
#include "truebearing/tracker/ensemble.hpp"
#include "truebearing/tracker/tracker.hpp"

namespace truebearing {

class CorrectedTracker final : public Tracker {
 public:
  /// The ensemble must have the model's base, reference, companions and covariance source among its members.
  CorrectedTracker(Ensemble ensemble, std::shared_ptr<const CorrectionModel> model, CorrectionBounds bounds = {})
      : ensemble_(std::move(ensemble)),
        model_(std::move(model)),
        bounds_(std::move(bounds)),
        correction_(model_, ensemble_, bounds_) {}

  std::span<const StepRecord> step(const Measurement& measurement) override {
    ensemble_.step(measurement);
    return correction_.correct(ensemble_);
  }

  void reset() override {
    ensemble_.reset();
    correction_.reset();
  }

  bool assign(const Tracker& other) override {
    const auto* corrected = dynamic_cast<const CorrectedTracker*>(&other);
    if (!corrected || !ensemble_.assign(corrected->ensemble_).empty()) return false;
    correction_ = corrected->correction_;
    return true;
  }

  std::unique_ptr<Tracker> fresh() const override {
    return std::make_unique<CorrectedTracker>(ensemble_.fresh(), model_, bounds_);
  }
  const StateSpace& space() const override { return *model_->space; }
  std::optional<Measured> measures() const override {
    return ensemble_.tracker(ensemble_.index(model_->design.base)).measures();
  }
  TrackerCounts counts() const override { return ensemble_.tracker(ensemble_.index(model_->design.base)).counts(); }
  std::span<const TrackEvent> events() const override {
    return ensemble_.tracker(ensemble_.index(model_->design.base)).events();
  }

  const CorrectionModel& model() const { return *model_; }

 private:
  Ensemble ensemble_;
  std::shared_ptr<const CorrectionModel> model_;
  CorrectionBounds bounds_;
  Correction correction_;
};

}  // namespace truebearing
