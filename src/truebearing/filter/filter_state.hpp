// SPDX-License-Identifier: Apache-2.0
// FilterState puts a fixed-size filter (KalmanFilter and its like) behind the seam of tracked_state.hpp. It is compiled
// for a filter of N states and measurements of M components, whatever the models.
#pragma once

#include <memory>
#include <type_traits>
#include <utility>

#include "truebearing/core/constants.hpp"
#include "truebearing/filter/any_measurement.hpp"
#include "truebearing/filter/erased_motion.hpp"
#include "truebearing/filter/leading_identity.hpp"
#include "truebearing/filter/small_matrix.hpp"
#include "truebearing/filter/tracked_state.hpp"
#include "truebearing/filter/update.hpp"
#include "truebearing/measurement/bearing.hpp"
#include "truebearing/motion/any_motion.hpp"

namespace truebearing {

namespace detail {

/// Whether a measured position has a compiled form of its own: of a state on the line or in the plane.
template <int N, int M>
inline constexpr bool kHasPositionForm = M == (N <= 3 ? 1 : 2) && N <= 6;

/// A measured position on a state of N components that it begins.
template <int N, int M>
struct MeasuredPosition {
  using Scalar = double;
  static constexpr int kStates = N;
  static constexpr int kMeasurements = M;
  using State = Eigen::Matrix<double, N, 1>;
  using Vector = Eigen::Matrix<double, M, 1>;
  using Covariance = Eigen::Matrix<double, M, M>;

  const Covariance& R_m2;

  Vector h(const State& x) const { return x.template head<M>(); }
  LeadingIdentity<M, N> H(const State&) const { return {}; }
  const Covariance& R() const { return R_m2; }
  Vector residual(const Vector& z, const Vector& z_pred) const { return z - z_pred; }
};
static_assert(MeasurementModel<MeasuredPosition<5, 2>>);

/// Four components at once are measured of targets in space alone.
template <int N, int M>
inline constexpr bool kTakesLength = M <= 3 || N >= 6;

template <typename Filter, int M>
[[gnu::noinline]] Update<Filter::kStates, M> update_by_any(Filter& filter, const SizedMeasurement<M>& measurement) {
  constexpr int N = Filter::kStates;
  if constexpr (kTakesLength<N, M> && requires { filter.update(MeasurementOn<N, M>{measurement}, measurement.z); }) {
    return filter.update(MeasurementOn<N, M>{measurement}, measurement.z);
  } else {
    if constexpr (M == 1)  // a filter of bearings alone, which asks for more than h and H
      if (const auto* bearing = dynamic_cast<const ErasedMeasurement<Bearing<>>*>(&measurement))
        return filter.update(bearing->model(), measurement.z);
    return {Eigen::Matrix<double, M, 1>::Constant(kNaN), Eigen::Matrix<double, M, M>::Constant(kNaN),
            Eigen::Matrix<double, N, M>::Constant(kNaN), kNaN, StepStatus::failed};
  }
}

}  // namespace detail

/// A filter's update with a measurement whose model is not known here; but of a measured position the compiler knows
/// H = [I, 0].
template <typename Filter, int M>
EIGEN_ALWAYS_INLINE Update<Filter::kStates, M> update_by(Filter& filter, const SizedMeasurement<M>& measurement) {
  if constexpr (detail::kHasPositionForm<Filter::kStates, M>) {
    const detail::MeasuredPosition<Filter::kStates, M> position{measurement.R};
    if constexpr (requires { filter.update(position, measurement.z); })
      if (measurement.is_position()) return filter.update(position, measurement.z);
  }
  return detail::update_by_any(filter, measurement);
}

template <typename FilterType>
class FilterState final : public TrackedState {
 public:
  using Filter = FilterType;
  static constexpr int N = Filter::kStates;
  using State = Eigen::Matrix<double, N, 1>;
  using Covariance = Eigen::Matrix<double, N, N>;
  using Motion = SizedMotion<N>;

  explicit FilterState(std::shared_ptr<const Motion> motion)
      : TrackedState(N), motion_(std::move(motion)), filter_(State::Zero(), Covariance::Identity()) {
    show();
  }

  const std::shared_ptr<const Motion>& motion() const { return motion_; }

  void begin(const double* x, const double* P) override {
    filter_ = Filter(matrix_at<N, 1>(x), matrix_at<N, N>(P));
    show();
  }

  StepStatus predict(double dt_s) override {
    const StepStatus status = filter_.predict(*motion_, dt_s, made_);
    show();
    return status;
  }

  StepStatus update(const AnyMeasurement& measurement, const StateUpdateTarget& update) override {
    return with_length(measurement, [&](const auto& sized) { return take(sized, update); });
  }

  void assign(const TrackedState& other) override {
    filter_ = static_cast<const FilterState&>(other).filter_;
    show();
  }

  std::unique_ptr<TrackedState> fresh() const override { return std::make_unique<FilterState>(motion_); }

  BoundedMatrix cross_covariance(double dt_s) const override {
    if constexpr (requires { filter_.cross_covariance(*motion_, dt_s); })
      if (!motion_->is_linear()) return filter_.cross_covariance(*motion_, dt_s);
    return filter_.P() * motion_->F(filter_.x(), dt_s).transpose();
  }

 private:
  static constexpr bool kCarriesP = std::is_reference_v<decltype(std::declval<const Filter&>().P())>;

  /// Of a filter that carries another form than P itself, P is made here.
  void show() {
    if constexpr (kCarriesP) {
      estimate_at(filter_.x().data(), filter_.P().data());
    } else {
      shown_P_ = filter_.P();
      estimate_at(filter_.x().data(), shown_P_.data());
    }
  }

  template <int M>
  StepStatus take(const SizedMeasurement<M>& measurement, const StateUpdateTarget& update) {
    const Update<N, M> fixed = update_by(filter_, measurement);
    show();
    update.nu = fixed.nu;
    update.S = fixed.S;
    update.K = fixed.K;
    update.nis = fixed.nis;
    return fixed.status;
  }

  struct None {};
  std::shared_ptr<const Motion> motion_;
  Transition<N> made_;
  Filter filter_;
  [[no_unique_address]] std::conditional_t<kCarriesP, None, Covariance> shown_P_;
};

/// `Filter` under `motion`, a model of a known type.
template <typename Filter, MotionModel Motion>
std::unique_ptr<TrackedState> state_of(Motion motion) {
  return std::make_unique<FilterState<Filter>>(erased(std::move(motion)));
}

}  // namespace truebearing
