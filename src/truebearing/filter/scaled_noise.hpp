// SPDX-License-Identifier: Apache-2.0
// A filter that takes its measurements to be so many times as noisy as their model says: R becomes factor^2 R. Modes of
// a multiple model that differ in this alone, each entered with its own probability whatever came before, follow a
// target through noise that is now of one variance and now of another (Bar-Shalom, Li and Kirubarajan 2001, sec. 11.6).
#pragma once

#include <memory>
#include <utility>

#include "truebearing/filter/tracked_state.hpp"

namespace truebearing {

/// A measurement with another R.
template <int M>
class ScaledMeasurement final : public SizedMeasurement<M> {
 public:
  using typename SizedMeasurement<M>::Vector;

  ScaledMeasurement(const SizedMeasurement<M>& measurement, double factor)
      : SizedMeasurement<M>(measurement.is_position()), measurement_(measurement) {
    this->z = measurement.z;
    this->R = factor * factor * measurement.R;
  }

  Vector h(const double* x) const override { return measurement_.h(x); }
  void H(const double* x, double* jacobian) const override { measurement_.H(x, jacobian); }
  void modified_gain(const double* x, double* g) const override { measurement_.modified_gain(x, g); }
  void residuals_of(const double* X, int stride, int count, const Vector& z_0, double* residuals) const override {
    measurement_.residuals_of(X, stride, count, z_0, residuals);
  }
  Vector residual(const Vector& a, const Vector& b) const override { return measurement_.residual(a, b); }

 private:
  const SizedMeasurement<M>& measurement_;
};

class ScaledNoise final : public TrackedState {
 public:
  /// sigma_factor > 0, of the standard deviations.
  ScaledNoise(std::unique_ptr<TrackedState> state, double sigma_factor)
      : TrackedState(state->size()), state_(std::move(state)), sigma_factor_(sigma_factor) {
    estimate_at(state_->x_data(), state_->P_data());
  }

  void begin(const double* x, const double* P) override { state_->begin(x, P); }
  StepStatus predict(double dt_s) override { return state_->predict(dt_s); }
  StepStatus update(const AnyMeasurement& measurement, const StateUpdateTarget& update) override {
    return with_length(measurement, [&]<int M>(const SizedMeasurement<M>& sized) {
      return state_->update(ScaledMeasurement<M>(sized, sigma_factor_), update);
    });
  }
  void assign(const TrackedState& other) override { state_->assign(*static_cast<const ScaledNoise&>(other).state_); }
  std::unique_ptr<TrackedState> fresh() const override {
    return std::make_unique<ScaledNoise>(state_->fresh(), sigma_factor_);
  }
  BoundedMatrix cross_covariance(double dt_s) const override { return state_->cross_covariance(dt_s); }

 private:
  std::unique_ptr<TrackedState> state_;  // one filter, whose estimate stands where it is
  double sigma_factor_;
};

}  // namespace truebearing
