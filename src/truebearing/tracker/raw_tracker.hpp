// SPDX-License-Identifier: Apache-2.0
// The raw measurement as a tracker: x = z, P = diag(sigma^2). What a user has without any filter; the row to beat.
#pragma once

#include "truebearing/tracker/publishable.hpp"
#include "truebearing/tracker/stream_guard.hpp"
#include "truebearing/tracker/tracker.hpp"

namespace truebearing {

class RawTracker final : public Tracker {
 public:
  /// space: what the measured components are. sigma: used where the measurement carries none (same size).
  RawTracker(const StateSpace& space, BoundedVector sigma) : space_(&space), sigma_(std::move(sigma)) { reset(); }

  std::span<const StepRecord> step(const Measurement& measurement) override {
    if (guard_.examine(measurement) != StreamGuard::Verdict::usable || measurement.z.size() != space_->size())
      return {};
    const BoundedVector& sigma = measurement.sigma.size() == measurement.z.size() ? measurement.sigma : sigma_;
    record_.time_s = measurement.time_s;
    record_.x = measurement.z;
    record_.P = sigma.cwiseAbs2().asDiagonal();
    record_.sensor = measurement.sensor;
    set_status(StepStatus::ok, record_);
    return {&record_, 1};
  }

  void reset() override {
    guard_ = {};
    record_ = {};
    record_.space = space_;
  }

  bool assign(const Tracker& other) override {
    const auto* raw = dynamic_cast<const RawTracker*>(&other);
    if (raw) *this = *raw;
    return raw != nullptr;
  }
  std::unique_ptr<Tracker> fresh() const override { return std::make_unique<RawTracker>(*space_, sigma_); }
  const StateSpace& space() const override { return *space_; }
  std::optional<Measured> measures() const override { return Measured::of(space_->components); }
  TrackerCounts counts() const override { return guard_.counts; }

 private:
  const StateSpace* space_;
  BoundedVector sigma_;
  StreamGuard guard_;
  StepRecord record_;
};

}  // namespace truebearing
