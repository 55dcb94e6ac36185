// SPDX-License-Identifier: Apache-2.0
// Learned motion: a motion model f_0 and what a fuzzy network says its prediction misses,
//     f(x, dt) = f_0(x, dt) + dt / T r(x),   F = F_0 + dt / T dr/dx,   Q = Q_0,   0 < dt <= T
// T the period that r was taught at; a longer dt is crossed in equal pieces. It stands inside a filter, whose gain and
// covariance follow from it: closed loop, and unlike an output correction (correction.hpp) not bounded by a trusted
// tracker. What bounds it is the network: r(x) lies in the hull of what its rules say, and is constant, with no slope,
// beyond the standard deviations of the states that were taught at which it cuts its inputs.
#pragma once

#include <Eigen/Core>
#include <map>
#include <memory>
#include <string>

#include "truebearing/correction/fuzzy_network.hpp"
#include "truebearing/motion/any_motion.hpp"
#include "truebearing/motion/equal_pieces.hpp"
#include "truebearing/motion/motion_model.hpp"

namespace truebearing {

/// r, of a state of n components: n inputs, n outputs, in the units of the state.
struct MotionResidual {
  FuzzyNetwork network;
  double period_s = 1.0;  ///< T
  std::map<std::string, std::string> provenance;
};

/// f_0 is of any type, and r that of a state as long.
template <int N>
struct LearnedMotion {
  using Scalar = double;
  static constexpr int kStates = N;
  using State = Eigen::Matrix<double, N, 1>;
  using Matrix = Eigen::Matrix<double, N, N>;

  std::shared_ptr<const SizedMotion<N>> around;  ///< f_0
  std::shared_ptr<const MotionResidual> residual;

  /// Not finite over more than EqualPieces::kMost periods.
  State f(const State& x, double dt_s) const {
    State at = x;
    const EqualPieces<double> cut(dt_s, residual->period_s);
    for (int i = 0; i < cut.count; ++i) at = crossed(at, cut.length_s);
    return at;
  }
  Matrix F(const State& x, double dt_s) const {
    State at = x;
    Matrix whole = Matrix::Identity();
    const EqualPieces<double> cut(dt_s, residual->period_s);
    for (int i = 0; i < cut.count; ++i) {
      FuzzyNetwork::Strengths phi;
      residual->network.strengths(at, phi);
      const Matrix slope = residual->network.jacobian(at, phi);
      whole = ((around->F(at, cut.length_s) + cut.length_s / residual->period_s * slope) * whole).eval();
      if (i + 1 < cut.count) at = crossed(at, cut.length_s);
    }
    return whole;
  }
  Matrix Q(double dt_s) const { return around->Q(dt_s); }

 private:
  State crossed(const State& x, double dt_s) const {
    FuzzyNetwork::Strengths phi;
    residual->network.strengths(x, phi);
    return around->f(x, dt_s) + dt_s / residual->period_s * State(residual->network.output(phi));
  }
};

static_assert(NonlinearMotionModel<LearnedMotion<3>>);

}  // namespace truebearing
