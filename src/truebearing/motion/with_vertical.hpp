// SPDX-License-Identifier: Apache-2.0
// A motion in the plane with a vertical channel above it, independent of each other: of [east, north, v_east, v_north,
// ...] and [up, v_up, ...] the state [east, north, up, v_east, v_north, v_up, ...] in m and m/s, and behind the
// velocities what the motions have more: accelerations in all three directions (n = 9), or the turn rate of the one in
// the plane alone (n = 7).
#pragma once

#include <Eigen/Core>

#include "truebearing/motion/motion_model.hpp"

namespace truebearing {

template <MotionModel Horizontal, LinearMotionModel Vertical>
requires((Vertical::kStates == 2 && (Horizontal::kStates == 4 || Horizontal::kStates == 5)) ||
         (Vertical::kStates == 3 && Horizontal::kStates == 6)) struct WithVertical {
  using Scalar = typename Horizontal::Scalar;
  static constexpr int kStates = Horizontal::kStates + Vertical::kStates;
  using State = Eigen::Matrix<Scalar, kStates, 1>;
  using Matrix = Eigen::Matrix<Scalar, kStates, kStates>;

  Horizontal horizontal;
  Vertical vertical;

  Matrix F(Scalar dt_s) const requires LinearMotionModel<Horizontal> {
    return together(horizontal.F(dt_s), vertical.F(dt_s));
  }
  /// Of a nonlinear motion in the plane.
  State f(const State& x, Scalar dt_s) const requires NonlinearMotionModel<Horizontal> {
    const Plane plane = horizontal.f(plane_of(x), dt_s);
    Eigen::Matrix<Scalar, Vertical::kStates, 1> up;
    for (int i = 0; i < Vertical::kStates; ++i) up(i) = x(vertical_place(i));
    up = (vertical.F(dt_s) * up).eval();
    State whole;
    for (int i = 0; i < Horizontal::kStates; ++i) whole(horizontal_place(i)) = plane(i);
    for (int i = 0; i < Vertical::kStates; ++i) whole(vertical_place(i)) = up(i);
    return whole;
  }
  Matrix F(const State& x, Scalar dt_s) const requires NonlinearMotionModel<Horizontal> {
    return together(horizontal.F(plane_of(x), dt_s), vertical.F(dt_s));
  }
  Matrix Q(Scalar dt_s) const { return together(horizontal.Q(dt_s), vertical.Q(dt_s)); }

 private:
  using Plane = Eigen::Matrix<Scalar, Horizontal::kStates, 1>;

  // Where a component of either stands in the state.
  static constexpr int horizontal_place(int i) { return i < 2 ? i : i < 4 ? i + 1 : i + 2; }
  static constexpr int vertical_place(int i) { return 3 * i + 2; }

  static Plane plane_of(const State& x) {
    Plane plane;
    for (int i = 0; i < Horizontal::kStates; ++i) plane(i) = x(horizontal_place(i));
    return plane;
  }

  static Matrix together(const Eigen::Matrix<Scalar, Horizontal::kStates, Horizontal::kStates>& plane,
                         const Eigen::Matrix<Scalar, Vertical::kStates, Vertical::kStates>& up) {
    Matrix whole = Matrix::Zero();
    for (int j = 0; j < Horizontal::kStates; ++j)
      for (int i = 0; i < Horizontal::kStates; ++i) whole(horizontal_place(i), horizontal_place(j)) = plane(i, j);
    for (int j = 0; j < Vertical::kStates; ++j)
      for (int i = 0; i < Vertical::kStates; ++i) whole(vertical_place(i), vertical_place(j)) = up(i, j);
    return whole;
  }
};

}  // namespace truebearing
