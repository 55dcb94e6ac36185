// SPDX-License-Identifier: Apache-2.0
// Constant velocity in Dim directions: x = [positions (Dim), velocities (Dim)] in m and m/s; in the plane
// [east, north, v_east, v_north]. F = [I, dt I; 0, I] (n x n, n = 2 Dim), Q from the noise policy.
#pragma once

#include <Eigen/Core>
#include <utility>

#include "truebearing/motion/motion_model.hpp"
#include "truebearing/motion/process_noise.hpp"

namespace truebearing {

template <int Dim, typename Noise, typename ScalarType = double>
struct ConstantVelocity {
  using Scalar = ScalarType;
  static constexpr int kStates = 2 * Dim;
  using Matrix = Eigen::Matrix<Scalar, kStates, kStates>;

  Noise noise;

  Matrix F(Scalar dt_s) const {
    Matrix transition;
    // Written out: of a loop's result the zeros would not be known where it is multiplied (filter/product.hpp).
    const auto set = [&](int row, int col) __attribute__((always_inline)) {
      transition(row, col) = row == col ? Scalar(1) : row + Dim == col ? dt_s : Scalar(0);
    };
    [&]<int... I>(std::integer_sequence<int, I...>) __attribute__((always_inline)) {
      (set(I % kStates, I / kStates), ...);
    }
    (std::make_integer_sequence<int, kStates * kStates>());
    return transition;
  }

  Matrix Q(Scalar dt_s) const { return noise.template Q<Dim, Scalar>(dt_s); }
};

static_assert(LinearMotionModel<ConstantVelocity<1, ContinuousWhiteNoise>>);
static_assert(LinearMotionModel<ConstantVelocity<2, DiscreteWhiteNoise, float>>);
static_assert(LinearMotionModel<ConstantVelocity<2, FixedNoise<4>>>);

}  // namespace truebearing
