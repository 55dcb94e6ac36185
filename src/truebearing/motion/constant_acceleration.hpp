// SPDX-License-Identifier: Apache-2.0
// Constant acceleration in Dim directions: x = [positions (Dim), velocities (Dim), accelerations (Dim)] in m, m/s and
// m/s^2. F = [1, dt, dt^2/2; 0, 1, dt; 0, 0, 1] in each direction (n x n, n = 3 Dim), Q from the noise policy.
// Bar-Shalom, Li and Kirubarajan 2001, section 6.2.3 (continuous) and 6.3.3 (discrete).
#pragma once

#include <Eigen/Core>

#include "truebearing/motion/motion_model.hpp"

namespace truebearing {

namespace detail {

/// The same block over [position, velocity, acceleration] in each of Dim directions.
template <int Dim, typename Scalar>
Eigen::Matrix<Scalar, 3 * Dim, 3 * Dim> in_each_direction(const Eigen::Matrix<Scalar, 3, 3>& block) {
  Eigen::Matrix<Scalar, 3 * Dim, 3 * Dim> all = Eigen::Matrix<Scalar, 3 * Dim, 3 * Dim>::Zero();
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i)
      for (int direction = 0; direction < Dim; ++direction) all(i * Dim + direction, j * Dim + direction) = block(i, j);
  return all;
}

}  // namespace detail

/// Jerk as continuous white noise of spectral density q: section 6.2.3. Crossing a then b is the same as crossing
/// a + b.
struct ContinuousWhiteJerk {
  double q;  ///< m^2/s^5

  template <int Dim, typename Scalar>
  Eigen::Matrix<Scalar, 3 * Dim, 3 * Dim> Q(Scalar dt_s) const {
    const Scalar aa = static_cast<Scalar>(q) * dt_s;
    const Scalar va = aa * dt_s / 2, vv = aa * dt_s * dt_s / 3;
    const Scalar pa = vv / 2, pv = va * dt_s * dt_s / 4, pp = pv * dt_s * 2 / 5;
    Eigen::Matrix<Scalar, 3, 3> block;
    block << pp, pv, pa, pv, vv, va, pa, va, aa;
    return detail::in_each_direction<Dim, Scalar>(block);
  }
};

/// The discrete Wiener process acceleration: an increment of the acceleration, constant over each step and white from
/// step to step, standard deviation sigma: section 6.3.3. The step is part of the model, and no time is no step:
/// Q(0) = 0 although Q does not vanish towards it.
struct DiscreteAccelerationStep {
  double sigma;  ///< m/s^2, per step

  template <int Dim, typename Scalar>
  Eigen::Matrix<Scalar, 3 * Dim, 3 * Dim> Q(Scalar dt_s) const {
    const Scalar acceleration = dt_s == 0 ? Scalar(0) : static_cast<Scalar>(sigma);
    const Eigen::Matrix<Scalar, 3, 1> gained(acceleration * dt_s * dt_s / 2, acceleration * dt_s, acceleration);
    return detail::in_each_direction<Dim, Scalar>(gained * gained.transpose());
  }
};

template <int Dim, typename Noise = ContinuousWhiteJerk, typename ScalarType = double>
struct ConstantAcceleration {
  using Scalar = ScalarType;
  static constexpr int kStates = 3 * Dim;
  using Matrix = Eigen::Matrix<Scalar, kStates, kStates>;

  Noise noise;

  Matrix F(Scalar dt_s) const {
    Eigen::Matrix<Scalar, 3, 3> block = Eigen::Matrix<Scalar, 3, 3>::Identity();
    block(0, 1) = block(1, 2) = dt_s;
    block(0, 2) = dt_s * dt_s / 2;
    return detail::in_each_direction<Dim, Scalar>(block);
  }

  Matrix Q(Scalar dt_s) const { return noise.template Q<Dim, Scalar>(dt_s); }
};

static_assert(LinearMotionModel<ConstantAcceleration<1>>);
static_assert(LinearMotionModel<ConstantAcceleration<2, DiscreteAccelerationStep, float>>);

}  // namespace truebearing
