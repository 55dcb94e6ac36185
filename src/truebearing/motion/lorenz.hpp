// SPDX-License-Identifier: Apache-2.0
// The Lorenz attractor, on which learned filters are compared: x = [x, y, z] (n = 3) without units and
//     dx/dt = A(x) x,  A(x) = [-10, 10, 0; 28 - z, -1, 0; y, 0, -8/3].
// Motions cross dt in equal pieces of at most step_s. A piece h goes by one of two steps:
//     LorenzTaylor       f = sum_{j <= J} (A(x) h)^j / j! x, A frozen at the beginning of the piece: of first order
//                        whatever J; Revach et al. 2022 (KalmanNet), section IV-D
//     LorenzRungeKutta   the classical one of fourth order
// and F is the whole Jacobian of f, with what A changes by.
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "truebearing/motion/equal_pieces.hpp"
#include "truebearing/motion/motion_model.hpp"

namespace truebearing {

namespace lorenz {

template <typename Scalar>
using State = Eigen::Matrix<Scalar, 3, 1>;
template <typename Scalar>
using Matrix = Eigen::Matrix<Scalar, 3, 3>;

/// A(x) v.
template <typename Scalar>
State<Scalar> flow(const State<Scalar>& x, const State<Scalar>& v) {
  return {Scalar(10) * (v(1) - v(0)), (Scalar(28) - x(2)) * v(0) - v(1), x(1) * v(0) - Scalar(8) / Scalar(3) * v(2)};
}

/// A(x).
template <typename Scalar>
Matrix<Scalar> A(const State<Scalar>& x) {
  Matrix<Scalar> a;
  a << -10, 10, 0, Scalar(28) - x(2), -1, 0, x(1), 0, Scalar(-8) / Scalar(3);
  return a;
}

/// d(A(x) v)/dx, v held.
template <typename Scalar>
Matrix<Scalar> dA(const State<Scalar>& v) {
  Matrix<Scalar> b;
  b << 0, 0, 0, 0, 0, -v(0), 0, v(0), 0;
  return b;
}

}  // namespace lorenz

struct LorenzTaylor {
  int terms = 5;  ///< J

  template <typename Scalar>
  lorenz::State<Scalar> f(const lorenz::State<Scalar>& x, Scalar h) const {
    lorenz::State<Scalar> term = x, sum = x;
    for (int j = 1; j <= terms; ++j) {
      term = h / static_cast<Scalar>(j) * lorenz::flow(x, term);
      sum += term;
    }
    return sum;
  }
  template <typename Scalar>
  lorenz::Matrix<Scalar> F(const lorenz::State<Scalar>& x, Scalar h) const {
    const lorenz::Matrix<Scalar> A = lorenz::A(x);
    lorenz::State<Scalar> term = x;
    lorenz::Matrix<Scalar> slope = lorenz::Matrix<Scalar>::Identity(), sum = slope;
    for (int j = 1; j <= terms; ++j) {
      const Scalar share = h / static_cast<Scalar>(j);
      slope = share * (lorenz::dA(term) + A * slope).eval();
      term = share * lorenz::flow(x, term);
      sum += slope;
    }
    return sum;
  }
};

struct LorenzRungeKutta {
  template <typename Scalar>
  lorenz::State<Scalar> f(const lorenz::State<Scalar>& x, Scalar h) const {
    using State = lorenz::State<Scalar>;
    const auto rate = [](const State& at) { return lorenz::flow(at, at); };
    const State k1 = rate(x), k2 = rate(x + h / 2 * k1), k3 = rate(x + h / 2 * k2), k4 = rate(x + h * k3);
    return x + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
  }
  template <typename Scalar>
  lorenz::Matrix<Scalar> F(const lorenz::State<Scalar>& x, Scalar h) const {
    using State = lorenz::State<Scalar>;
    using Matrix = lorenz::Matrix<Scalar>;
    const auto rate = [](const State& at) { return lorenz::flow(at, at); };
    const auto slope = [](const State& at) { return Matrix(lorenz::A(at) + lorenz::dA(at)); };
    const Matrix I = Matrix::Identity();
    const State x2 = x + h / 2 * rate(x), x3 = x + h / 2 * rate(x2), x4 = x + h * rate(x3);
    const Matrix K1 = slope(x), K2 = slope(x2) * (I + h / 2 * K1), K3 = slope(x3) * (I + h / 2 * K2),
                 K4 = slope(x4) * (I + h * K3);
    return I + h / 6 * (K1 + 2 * K2 + 2 * K3 + K4);
  }
};

/// Q = sigma^2 dt / step_s I.
template <typename Step, typename ScalarType = double>
struct LorenzMotion {
  using Scalar = ScalarType;
  static constexpr int kStates = 3;
  using State = lorenz::State<Scalar>;
  using Matrix = lorenz::Matrix<Scalar>;

  Step step;
  Scalar step_s;     ///< > 0
  Scalar sigma = 0;  ///< of the process noise, per component and step_s

  /// Not finite over more than EqualPieces::kMost pieces.
  State f(const State& x, Scalar dt_s) const {
    State at = x;
    const EqualPieces<Scalar> cut(dt_s, step_s);
    for (int i = 0; i < cut.count; ++i) at = step.f(at, cut.length_s);
    return at;
  }
  Matrix F(const State& x, Scalar dt_s) const {
    State at = x;
    Matrix whole = Matrix::Identity();
    const EqualPieces<Scalar> cut(dt_s, step_s);
    for (int i = 0; i < cut.count; ++i) {
      whole = (step.F(at, cut.length_s) * whole).eval();
      if (i + 1 < cut.count) at = step.f(at, cut.length_s);
    }
    return whole;
  }
  Matrix Q(Scalar dt_s) const { return sigma * sigma * dt_s / step_s * Matrix::Identity(); }
};

static_assert(NonlinearMotionModel<LorenzMotion<LorenzTaylor>>);
static_assert(NonlinearMotionModel<LorenzMotion<LorenzRungeKutta, float>>);

}  // namespace truebearing
