// SPDX-License-Identifier: Apache-2.0
// A motion in the plane with the frequency that the target radiates: [east, north, v_east, v_north, f0] and, where the
// motion has more, the rest behind it: [..., f0, a_east, a_north] as Kim and Song order their seven (equation 8). f0
// walks at random, independent of the motion: its variance grows by q_f dt.
#pragma once

#include <Eigen/Core>

#include "truebearing/motion/motion_model.hpp"

namespace truebearing {

template <MotionModel Motion>
requires(Motion::kStates >= 4) struct WithFrequency {
  using Scalar = typename Motion::Scalar;
  static constexpr int kStates = Motion::kStates + 1;
  static constexpr int kFrequency = 4;  ///< its place
  using State = Eigen::Matrix<Scalar, kStates, 1>;
  using Matrix = Eigen::Matrix<Scalar, kStates, kStates>;

  Motion motion;
  Scalar frequency_q_hz2ps = 0;  ///< q_f, Hz^2/s

  Matrix F(Scalar dt_s) const requires LinearMotionModel<Motion> { return around(motion.F(dt_s), 1); }
  /// Of a nonlinear motion.
  State f(const State& x, Scalar dt_s) const requires NonlinearMotionModel<Motion> {
    const typename Motion::State next = motion.f(without_frequency(x), dt_s);
    State whole;
    whole << next.template head<kFrequency>(), x(kFrequency), next.template tail<kStates - 1 - kFrequency>();
    return whole;
  }
  Matrix F(const State& x, Scalar dt_s) const requires NonlinearMotionModel<Motion> {
    return around(motion.F(without_frequency(x), dt_s), 1);
  }
  Matrix Q(Scalar dt_s) const { return around(motion.Q(dt_s), frequency_q_hz2ps * dt_s); }

 private:
  static Eigen::Matrix<Scalar, Motion::kStates, 1> without_frequency(const State& x) {
    Eigen::Matrix<Scalar, Motion::kStates, 1> rest;
    rest << x.template head<kFrequency>(), x.template tail<kStates - 1 - kFrequency>();
    return rest;
  }

  // The motion's matrix with a row and a column for the frequency between its velocities and the rest.
  static Matrix around(const Eigen::Matrix<Scalar, Motion::kStates, Motion::kStates>& A, Scalar frequency) {
    constexpr int rest = Motion::kStates - kFrequency;
    Matrix whole = Matrix::Zero();
    whole.template topLeftCorner<kFrequency, kFrequency>() = A.template topLeftCorner<kFrequency, kFrequency>();
    whole.template topRightCorner<kFrequency, rest>() = A.template topRightCorner<kFrequency, rest>();
    whole.template bottomLeftCorner<rest, kFrequency>() = A.template bottomLeftCorner<rest, kFrequency>();
    whole.template bottomRightCorner<rest, rest>() = A.template bottomRightCorner<rest, rest>();
    whole(kFrequency, kFrequency) = frequency;
    return whole;
  }
};

}  // namespace truebearing
