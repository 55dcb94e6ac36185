// SPDX-License-Identifier: Apache-2.0
// Coordinated turn at a rate that is estimated with the rest: x = [east, north, v_east, v_north, turn_rate] in m, m/s
// and rad/s, positive to starboard. Nonlinear: f, its Jacobian F (5 x 5) and Q = [Q of the noise policy, 0; 0, q dt].
// Bar-Shalom, Li and Kirubarajan 2001, section 11.7.2, in smooth functions of the angle turned.
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "truebearing/motion/coordinated_turn.hpp"

namespace truebearing {

namespace detail {

/// d sinc / d angle = (cos a - sinc a) / a; where the two nearly cancel, its series.
template <typename Scalar>
Scalar sinc_derivative(Scalar angle) {
  if (std::abs(angle) > Scalar(0.25)) return (std::cos(angle) - sinc(angle)) / angle;
  // The next term is a^11 / 518918400: below half a unit in the last place.
  const Scalar a2 = angle * angle;
  return -angle *
         (Scalar(1) / 3 -
          a2 * (Scalar(1) / 30 - a2 * (Scalar(1) / 840 - a2 * (Scalar(1) / 45360 - a2 * (Scalar(1) / 3991680)))));
}

}  // namespace detail

template <typename Noise, typename ScalarType = double>
struct TurningTarget {
  using Scalar = ScalarType;
  static constexpr int kStates = 5;
  using State = Eigen::Matrix<Scalar, kStates, 1>;
  using Matrix = Eigen::Matrix<Scalar, kStates, kStates>;

  Noise noise;  ///< of positions and velocities
  /// What the rate wanders by in one second, as a standard deviation: a random walk driven by white noise of spectral
  /// density q = turn_rate_noise_radps2^2 in rad^2/s^3. Over dt it grows with the square root of dt.
  Scalar turn_rate_noise_radps2;

  State f(const State& x, Scalar dt_s) const {
    State next;
    next.template head<4>().noalias() = detail::turn_transition(x(4), dt_s) * x.template head<4>();
    next(4) = x(4);
    return next;
  }

  Matrix F(const State& x, Scalar dt_s) const {
    const Scalar angle = x(4) * dt_s;
    const Scalar half = detail::sinc(angle / 2);
    const Scalar d_along = detail::sinc_derivative(angle);
    const Scalar d_across = detail::sinc(angle) - half * half / 2;  // of (1 - cos a) / a; 1/2 at a = 0
    const Scalar sine = std::sin(angle), cosine = std::cos(angle);
    Matrix jacobian = Matrix::Identity();
    jacobian.template topLeftCorner<4, 4>() = detail::turn_transition(x(4), dt_s);
    jacobian(0, 4) = dt_s * dt_s * (d_along * x(2) + d_across * x(3));
    jacobian(1, 4) = dt_s * dt_s * (d_along * x(3) - d_across * x(2));
    jacobian(2, 4) = dt_s * (cosine * x(3) - sine * x(2));
    jacobian(3, 4) = -dt_s * (cosine * x(2) + sine * x(3));
    return jacobian;
  }

  Matrix Q(Scalar dt_s) const {
    Matrix covariance = Matrix::Zero();
    covariance.template topLeftCorner<4, 4>() = noise.template Q<2, Scalar>(dt_s);
    covariance(4, 4) = turn_rate_noise_radps2 * turn_rate_noise_radps2 * dt_s;
    return covariance;
  }
};

static_assert(NonlinearMotionModel<TurningTarget<ContinuousWhiteNoise>>);
static_assert(NonlinearMotionModel<TurningTarget<DiscreteWhiteNoise, float>>);
static_assert(!LinearMotionModel<TurningTarget<ContinuousWhiteNoise>>);

}  // namespace truebearing
