// SPDX-License-Identifier: Apache-2.0
// Coordinated turn at a known rate: x = [east, north, v_east, v_north] in m and m/s, the velocity turning by
// turn_rate_radps, positive to starboard (clockwise, bearings growing). F (4 x 4) is exact. Bar-Shalom, Li and
// Kirubarajan 2001, section 11.7.1, there positive to port and singular at rate zero.
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "truebearing/motion/motion_model.hpp"
#include "truebearing/motion/process_noise.hpp"

namespace truebearing {

namespace detail {

/// sin(angle) / angle.
template <typename Scalar>
Scalar sinc(Scalar angle) {
  return angle == 0 ? Scalar(1) : std::sin(angle) / angle;
}

/// The transition of [east, north, v_east, v_north] over a turn. With (1 - cos a) / a written as sin(a/2) sinc(a/2)
/// nothing cancels, so that small rates and rate zero need no series of their own.
template <typename Scalar>
Eigen::Matrix<Scalar, 4, 4> turn_transition(Scalar turn_rate_radps, Scalar dt_s) {
  const Scalar angle = turn_rate_radps * dt_s;
  const Scalar along = dt_s * sinc(angle);
  const Scalar across = dt_s * std::sin(angle / 2) * sinc(angle / 2);
  Eigen::Matrix<Scalar, 4, 4> F = Eigen::Matrix<Scalar, 4, 4>::Identity();
  F(0, 2) = F(1, 3) = along;
  F(0, 3) = across;
  F(1, 2) = -across;
  F(2, 2) = F(3, 3) = std::cos(angle);
  F(2, 3) = std::sin(angle);
  F(3, 2) = -F(2, 3);
  return F;
}

}  // namespace detail

/// Q is that of the noise policy for straight motion: the turn during one step is left out of how the noise spreads
/// from velocities to positions.
template <typename Noise, typename ScalarType = double>
struct CoordinatedTurn {
  using Scalar = ScalarType;
  static constexpr int kStates = 4;
  using Matrix = Eigen::Matrix<Scalar, kStates, kStates>;

  Noise noise;
  Scalar turn_rate_radps;

  Matrix F(Scalar dt_s) const { return detail::turn_transition(turn_rate_radps, dt_s); }
  Matrix Q(Scalar dt_s) const { return noise.template Q<2, Scalar>(dt_s); }
};

static_assert(LinearMotionModel<CoordinatedTurn<ContinuousWhiteNoise>>);
static_assert(LinearMotionModel<CoordinatedTurn<DiscreteWhiteNoise, float>>);

}  // namespace truebearing
