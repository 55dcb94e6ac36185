// SPDX-License-Identifier: Apache-2.0
// Singer's model of a manoeuvring target in Dim directions: x = [positions, velocities, accelerations] (n = 3 Dim) in
// m, m/s and m/s^2, the acceleration a first-order Markov process of standard deviation sigma_a_mps2 and correlation
// exp(-dt / time_constant_s). F and Q (n x n) are exact. Singer 1970.
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "truebearing/motion/constant_acceleration.hpp"
#include "truebearing/motion/motion_model.hpp"

namespace truebearing {

namespace detail {

/// sum_{k >= First} (-1)^k (a + b k + c 2^k) theta^(k - First) / k!: what is left of
///     (a - b theta) e^-theta + c e^-2theta
/// without the first terms of its series, over theta^First. Every integral of the model is of this kind. The printed
/// closed forms lose First powers of theta to cancellation; below 1/2 the series is summed instead.
template <int First, typename Scalar>
Scalar exponential_tail(Scalar theta, Scalar a, Scalar b, Scalar c) {
  constexpr int kTerms = 16;  // at theta = 1/2 the next one is below 1 / 18!
  const bool small = std::abs(theta) < Scalar(0.5);
  Scalar term = 1, two_to_k = 1, head = 0, tail = 0;
  Scalar theta_to_first = 1;
  for (int k = 0; k < First; ++k) {
    head += (a + b * static_cast<Scalar>(k) + c * two_to_k) * term * theta_to_first;
    term /= -static_cast<Scalar>(k + 1);
    theta_to_first *= theta;
    two_to_k *= 2;
  }
  if (!small) return ((a - b * theta) * std::exp(-theta) + c * std::exp(-2 * theta) - head) / theta_to_first;
  for (int k = First; k < First + kTerms; ++k) {
    tail += (a + b * static_cast<Scalar>(k) + c * two_to_k) * term;
    term *= -theta / static_cast<Scalar>(k + 1);
    two_to_k *= 2;
  }
  return tail;
}

}  // namespace detail

/// As time_constant_s grows at fixed 2 sigma_a_mps2^2 / time_constant_s this becomes constant acceleration with white
/// jerk of that density; as it shrinks at fixed 2 sigma_a_mps2^2 time_constant_s, constant velocity with white
/// acceleration of that density.
template <int Dim, typename ScalarType = double>
struct Singer {
  using Scalar = ScalarType;
  static constexpr int kStates = 3 * Dim;
  using Matrix = Eigen::Matrix<Scalar, kStates, kStates>;

  Scalar sigma_a_mps2;
  Scalar time_constant_s;  ///< > 0

  Matrix F(Scalar dt_s) const {
    const Scalar theta = dt_s / time_constant_s;
    Eigen::Matrix<Scalar, 3, 3> block = Eigen::Matrix<Scalar, 3, 3>::Identity();
    block(0, 1) = dt_s;
    block(0, 2) = dt_s * dt_s * detail::exponential_tail<2, Scalar>(theta, 1, 0, 0);
    block(1, 2) = dt_s * mean_decay(theta);
    block(2, 2) = std::exp(-theta);
    return detail::in_each_direction<Dim, Scalar>(block);
  }

  Matrix Q(Scalar dt_s) const {
    const Scalar theta = dt_s / time_constant_s, dt2 = dt_s * dt_s, decay = mean_decay(theta);
    const Scalar variance = sigma_a_mps2 * sigma_a_mps2;
    const Scalar scale = variance / time_constant_s;  // half the spectral density that drives the acceleration
    const Scalar pp = scale * dt2 * dt2 * dt_s * detail::exponential_tail<5, Scalar>(theta, 0, 4, -1);
    const Scalar pv = scale * dt2 * dt2 * detail::exponential_tail<4, Scalar>(theta, -2, -2, 1);
    const Scalar pa = scale * dt2 * dt_s * detail::exponential_tail<3, Scalar>(theta, 0, 2, -1);
    const Scalar vv = scale * dt2 * dt_s * detail::exponential_tail<3, Scalar>(theta, 4, 0, -1);
    const Scalar va = scale * dt2 * decay * decay;
    const Scalar aa = -variance * std::expm1(-2 * theta);
    Eigen::Matrix<Scalar, 3, 3> block;
    block << pp, pv, pa, pv, vv, va, pa, va, aa;
    return detail::in_each_direction<Dim, Scalar>(block);
  }

 private:
  /// (1 - e^-theta) / theta.
  static Scalar mean_decay(Scalar theta) { return theta == 0 ? Scalar(1) : -std::expm1(-theta) / theta; }
};

static_assert(LinearMotionModel<Singer<1>>);
static_assert(LinearMotionModel<Singer<2, float>>);

}  // namespace truebearing
