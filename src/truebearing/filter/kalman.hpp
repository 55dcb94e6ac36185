// SPDX-License-Identifier: Apache-2.0
// The Kalman filter (Kalman 1960), and with a nonlinear motion or measurement model the first-order extended one: state
// x (n), covariance P (n x n). A small value: no heap, no virtual call; Form says how P is carried and updated.
//     predict  x = F x or f(x),  P = F P F' + Q
//     update   nu = residual(z, h(x)),  x = x + K nu,  P as Form says
// Bar-Shalom, Li and Kirubarajan 2001, sections 5.2.3 and 10.3; the Jacobians F and H are taken at the estimate before
// the step.
#pragma once

#include <Eigen/Core>
#include <type_traits>

#include "truebearing/core/status.hpp"
#include "truebearing/filter/covariance_form.hpp"
#include "truebearing/filter/product.hpp"
#include "truebearing/filter/square_root.hpp"
#include "truebearing/filter/update.hpp"
#include "truebearing/measurement/measurement_model.hpp"
#include "truebearing/motion/any_motion.hpp"
#include "truebearing/motion/motion_model.hpp"

namespace truebearing {

/// Form: Joseph, SquareRoot, or, for comparison, Conventional.
template <int N, typename Form = Joseph, typename ScalarType = double>
class KalmanFilter {
 public:
  using Scalar = ScalarType;
  static constexpr int kStates = N;
  using State = Eigen::Matrix<Scalar, N, 1>;
  using Covariance = Eigen::Matrix<Scalar, N, N>;

  /// P0 may be singular. Where it is not positive semi-definite P() is NaN and every step says `failed`.
  KalmanFilter(const State& x0, const Covariance& P0)
      : x_(x0), carried_(Form::template from_covariance<N, Scalar>(P0)) {}

  /// Crosses dt_s seconds. `failed` leaves x and P as they were: a result that is not finite, a P or Q that is not
  /// positive semi-definite.
  template <LinearMotionModel Motion>
  EIGEN_ALWAYS_INLINE StepStatus predict(const Motion& motion, Scalar dt_s) {
    static_assert(Motion::kStates == N && std::is_same_v<typename Motion::Scalar, Scalar>);
    const Covariance& F = motion.F(dt_s);
    const State x = product(F, x_);
    Covariance carried = carried_;
    const bool valid = Form::template predict<N, Scalar>(F, motion.Q(dt_s), carried);
    return commit(valid, x, carried, x_, carried_);
  }

  /// The same across a nonlinear motion: P by the Jacobian at the estimate before.
  template <NonlinearMotionModel Motion>
  EIGEN_ALWAYS_INLINE StepStatus predict(const Motion& motion, Scalar dt_s) {
    static_assert(Motion::kStates == N && std::is_same_v<typename Motion::Scalar, Scalar>);
    const State x = motion.f(x_, dt_s);
    Covariance carried = carried_;
    const bool valid = Form::template predict<N, Scalar>(motion.F(x_, dt_s), motion.Q(dt_s), carried);
    return commit(valid, x, carried, x_, carried_);
  }

  /// The same across a motion whose type is not known here: it carries the estimate itself, where Form carries P.
  StepStatus predict(const SizedMotion<N>& motion, double dt_s) requires std::is_same_v<Scalar, double> {
    Transition<N> made;
    return predict(motion, dt_s, made);
  }
  /// made: by this motion, or nothing yet; becomes that of dt_s.
  StepStatus predict(const SizedMotion<N>& motion, double dt_s,
                     Transition<N>& made) requires std::is_same_v<Scalar, double> {
    return Form::template across<N>(motion, dt_s, x_, carried_, made);
  }

  /// Takes one measurement z (m). `failed` leaves x and P as they were: z, R or the result not finite, R, S or P not
  /// positive (semi-)definite, or S so ill-conditioned that the result would not be worth having.
  template <MeasurementModel Model>
  EIGEN_ALWAYS_INLINE Update<N, Model::kMeasurements, Scalar> update(
      const Model& model, const Eigen::Matrix<Scalar, Model::kMeasurements, 1>& z) {
    static_assert(Model::kStates == N && std::is_same_v<typename Model::Scalar, Scalar>);
    constexpr int M = Model::kMeasurements;
    Update<N, M, Scalar> update;
    update.nu = model.residual(z, model.h(x_));
    Covariance carried = carried_;
    const bool valid = Form::template update<N, M, Scalar>(carried, detail::jacobian_of(model, x_), model.R(), update);
    State x;
    copy(x_, x);
    add_product<1>(update.K, update.nu, x);
    update.status = commit(valid, x, carried, x_, carried_);
    return update;
  }

  const State& x() const { return x_; }
  /// A reference for the forms that carry P, a value for the square root.
  decltype(auto) P() const { return Form::template to_covariance<N, Scalar>(carried_); }

 private:
  State x_;
  Covariance carried_;
};

}  // namespace truebearing
