// SPDX-License-Identifier: Apache-2.0
// The extended Kalman filter in log-polar coordinates, for bearings in the plane: y = [bearing, ln range, and their
// rates] (measurement/log_polar.hpp), in which a bearing is linear, h(y) = y_0, so that an update cannot mistake what
// bearings do not tell for something they do. x (4), P (4 x 4).
//
// Between measurements it carries the Cartesian x and P, in which motion is linear. That is the log-polar filter
// exactly, not a mixture: its prediction y -> y(f(x(y))) has the Jacobian G F J with G = dy/dx and J = dx/dy, so P_y =
// G (F J P_y J' F' + Q) G', and J P_y J' is the P that is carried. In an update P_y = G P G' gives the same nu, S and
// gain as the Cartesian filter, G K for K; what differs is where the step leads:
//     y = y(x_pred) + G K nu,  P_y = G [(I - K H) P (I - K H)' + K R K'] G',  x = x(y),  P = J(y) P_y J(y)'
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "truebearing/filter/kalman.hpp"
#include "truebearing/measurement/bearing.hpp"
#include "truebearing/measurement/log_polar.hpp"

namespace truebearing {

/// A small value: no heap, no virtual call. The interface of KalmanFilter.
template <typename ScalarType = double>
class LogPolarFilter {
 public:
  using Scalar = ScalarType;
  static constexpr int kStates = 4;
  using State = Eigen::Matrix<Scalar, 4, 1>;
  using Covariance = Eigen::Matrix<Scalar, 4, 4>;

  /// As KalmanFilter's: where P0 is not positive semi-definite P() is NaN and every step says `failed`.
  LogPolarFilter(const State& x0, const Covariance& P0) : filter_(x0, P0) {}

  template <MotionModel Motion, typename... Made>
  StepStatus predict(const Motion& motion, Scalar dt_s, Made&... made) {
    return filter_.predict(motion, dt_s, made...);
  }

  /// `failed`, which leaves x and P as they were, as in KalmanFilter; where the target is predicted at the sensor; and
  /// where one bearing would change the range more than a hundredfold, far beyond what a derivative can say of an
  /// exponential.
  /// K in the result is the Cartesian gain.
  Update<4, 1, Scalar> update(const Bearing<Scalar>& bearing, const Eigen::Matrix<Scalar, 1, 1>& z) {
    const State x_pred = filter_.x();
    KalmanFilter<4, Joseph, Scalar> cartesian = filter_;
    Update<4, 1, Scalar> update = cartesian.update(bearing, z);
    const Covariance G = log_polar_jacobian<Scalar>(x_pred, bearing.site_m, bearing.site_velocity_mps);
    const State step = G * (update.K * update.nu);
    const State y = log_polar<Scalar>(x_pred, bearing.site_m, bearing.site_velocity_mps) + step;
    const Covariance T = product(from_log_polar_jacobian<Scalar>(y), G);
    const Covariance TP = product(T, Covariance(cartesian.P()));
    Covariance P = Covariance::Zero();
    add_product<1, Part::lower>(TP, transposed(T), P);

    const State x = from_log_polar<Scalar>(y, bearing.site_m, bearing.site_velocity_mps);
    const KalmanFilter<4, Joseph, Scalar> updated(x, P);
    const bool valid = std::abs(step(1)) <= kMostLogFactor && x.allFinite() && updated.P().allFinite();
    if (!valid) update.status = StepStatus::failed;
    if (update.status == StepStatus::ok) filter_ = updated;
    return update;
  }

  const State& x() const { return filter_.x(); }
  const Covariance& P() const { return filter_.P(); }

 private:
  static constexpr Scalar kMostLogFactor = Scalar(4.605170185988092);  // ln 100

  KalmanFilter<4, Joseph, Scalar> filter_;
};

}  // namespace truebearing
