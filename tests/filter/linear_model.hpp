// SPDX-License-Identifier: Apache-2.0
// A linear measurement model and a linear motion model of any given matrices, for tests; and a linear motion model that
// says it is not linear.
#pragma once

#include <Eigen/Core>

#include "truebearing/motion/motion_model.hpp"

namespace truebearing {

template <int N, int M, typename ScalarType = double>
struct LinearMeasurement {
  using Scalar = ScalarType;
  static constexpr int kStates = N;
  static constexpr int kMeasurements = M;
  using Vector = Eigen::Matrix<Scalar, M, 1>;
  using State = Eigen::Matrix<Scalar, N, 1>;

  Eigen::Matrix<Scalar, M, N> jacobian;
  Eigen::Matrix<Scalar, M, M> noise;

  Vector h(const State& x) const { return jacobian * x; }
  Eigen::Matrix<Scalar, M, N> H(const State&) const { return jacobian; }
  Eigen::Matrix<Scalar, M, M> R() const { return noise; }
  Vector residual(const Vector& z, const Vector& z_pred) const { return z - z_pred; }
};

template <int N>
struct LinearMotion {
  using Scalar = double;
  static constexpr int kStates = N;

  Eigen::Matrix<double, N, N> transition;
  Eigen::Matrix<double, N, N> noise;

  Eigen::Matrix<double, N, N> F(double) const { return transition; }
  Eigen::Matrix<double, N, N> Q(double) const { return noise; }
};

template <LinearMotionModel Motion>
struct AsNonlinear {
  using Scalar = typename Motion::Scalar;
  static constexpr int kStates = Motion::kStates;
  using State = Eigen::Matrix<Scalar, kStates, 1>;
  using Matrix = Eigen::Matrix<Scalar, kStates, kStates>;

  Motion motion;

  State f(const State& x, Scalar dt_s) const { return motion.F(dt_s) * x; }
  Matrix F(const State&, Scalar dt_s) const { return motion.F(dt_s); }
  Matrix Q(Scalar dt_s) const { return motion.Q(dt_s); }
};

}  // namespace truebearing
