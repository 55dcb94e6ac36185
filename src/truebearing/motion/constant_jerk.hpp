// SPDX-License-Identifier: Apache-2.0
// Constant jerk in Dim directions: x = [positions (Dim), velocities (Dim), accelerations (Dim), jerks (Dim)] in m, m/s,
// m/s^2 and m/s^3, the jerk driven by continuous white noise of spectral density q in m^2/s^7 (n = 4 Dim). In each
// direction F_ij = dt^(j-i) / (j-i)! for j >= i and, with a = 3 - i and b = 3 - j,
//     Q_ij = q dt^(a+b+1) / ((a+b+1) a! b!)
// Mehrotra and Mahapatra 1997, with an infinite time constant.
#pragma once

#include <Eigen/Core>

#include "truebearing/motion/motion_model.hpp"

namespace truebearing {

template <int Dim, typename ScalarType = double>
struct ConstantJerk {
  using Scalar = ScalarType;
  static constexpr int kStates = 4 * Dim;
  using Matrix = Eigen::Matrix<Scalar, kStates, kStates>;

  Scalar q_m2ps7;

  Matrix F(Scalar dt_s) const {
    const Scalar gained[] = {1, dt_s, dt_s * dt_s / 2, dt_s * dt_s * dt_s / 6};
    Matrix transition = Matrix::Zero();
    for (int i = 0; i < 4; ++i)
      for (int j = i; j < 4; ++j)
        for (int d = 0; d < Dim; ++d) transition(i * Dim + d, j * Dim + d) = gained[j - i];
    return transition;
  }

  Matrix Q(Scalar dt_s) const {
    constexpr Scalar kFactorial[] = {1, 1, 2, 6};
    Scalar powers[8] = {1};
    for (int k = 1; k < 8; ++k) powers[k] = powers[k - 1] * dt_s;
    Matrix noise = Matrix::Zero();
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) {
        const int a = 3 - i, b = 3 - j, k = a + b + 1;
        const Scalar value = q_m2ps7 * powers[k] / (static_cast<Scalar>(k) * kFactorial[a] * kFactorial[b]);
        for (int d = 0; d < Dim; ++d) noise(i * Dim + d, j * Dim + d) = value;
      }
    return noise;
  }
};

static_assert(LinearMotionModel<ConstantJerk<1>>);
static_assert(LinearMotionModel<ConstantJerk<1, float>>);

}  // namespace truebearing
