// SPDX-License-Identifier: Apache-2.0
// Process noises of kinematic models, as policies: Q (2 Dim x 2 Dim) gathered over dt for a state [positions,
// velocities], independent in each direction. Bar-Shalom, Li and Kirubarajan 2001, section 6.2 (continuous) and 6.3
// (discrete).
#pragma once

#include <Eigen/Core>
#include <variant>

namespace truebearing {

namespace detail {

/// [pp I, pv I; pv I, vv I]: the same 2 x 2 block in each of Dim directions.
template <int Dim, typename Scalar>
Eigen::Matrix<Scalar, 2 * Dim, 2 * Dim> kinematic_blocks(Scalar pp, Scalar pv, Scalar vv) {
  Eigen::Matrix<Scalar, 2 * Dim, 2 * Dim> Q = Eigen::Matrix<Scalar, 2 * Dim, 2 * Dim>::Zero();
  for (int i = 0; i < Dim; ++i) {
    Q(i, i) = pp;
    Q(Dim + i, i) = Q(i, Dim + i) = pv;
    Q(Dim + i, Dim + i) = vv;
  }
  return Q;
}

}  // namespace detail

/// Acceleration as continuous white noise of spectral density q: equation (6.2.2-12). Crossing a then b is the same as
/// crossing a + b.
struct ContinuousWhiteNoise {
  double q;  ///< m^2/s^3

  template <int Dim, typename Scalar>
  Eigen::Matrix<Scalar, 2 * Dim, 2 * Dim> Q(Scalar dt_s) const {
    const Scalar density = static_cast<Scalar>(q);
    const Scalar velocity = density * dt_s;
    return detail::kinematic_blocks<Dim, Scalar>(velocity * dt_s * dt_s / 3, velocity * dt_s / 2, velocity);
  }
};

/// Acceleration constant over each step and white from step to step, standard deviation sigma_a: equation (6.3.2-4).
/// Crossing a then b is not crossing a + b: the step is part of the model.
struct DiscreteWhiteNoise {
  double sigma_a;  ///< m/s^2

  template <int Dim, typename Scalar>
  Eigen::Matrix<Scalar, 2 * Dim, 2 * Dim> Q(Scalar dt_s) const {
    const Scalar velocity = static_cast<Scalar>(sigma_a) * dt_s;  // the standard deviation gained over the step
    const Scalar position = velocity * dt_s / 2;
    return detail::kinematic_blocks<Dim, Scalar>(position * position, position * velocity, velocity * velocity);
  }
};

/// A published matrix that is added once per step of period_s. It belongs to that period; at another dt it is scaled by
/// dt / period_s, which keeps the variance added per second but not the correlation that crossing several steps builds
/// up.
template <int States>
struct FixedNoise {
  Eigen::Matrix<double, States, States> Q_per_step;  ///< symmetric positive semi-definite, in the units of the state
  double period_s;                                   ///< > 0

  template <int Dim, typename Scalar>
  Eigen::Matrix<Scalar, 2 * Dim, 2 * Dim> Q(Scalar dt_s) const {
    static_assert(States == 2 * Dim, "the matrix has the size of the state");
    return Q_per_step.template cast<Scalar>() * (dt_s / static_cast<Scalar>(period_s));
  }
};

/// One of the three, chosen at run time: one type of filter for all of them, at the price of one branch a step.
template <int States>
struct AnyNoise {
  std::variant<ContinuousWhiteNoise, DiscreteWhiteNoise, FixedNoise<States>> noise;

  template <int Dim, typename Scalar>
  Eigen::Matrix<Scalar, 2 * Dim, 2 * Dim> Q(Scalar dt_s) const {
    return std::visit([&](const auto& chosen) { return chosen.template Q<Dim, Scalar>(dt_s); }, noise);
  }
};

}  // namespace truebearing
