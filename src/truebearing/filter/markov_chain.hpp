// SPDX-License-Identifier: Apache-2.0
// A Markov chain between the modes of a multiple-model filter: Pi (r x r), Pi_ij the probability that mode i is
// followed by mode j one period later.
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "truebearing/core/bounded.hpp"

namespace truebearing {

struct MarkovChain {
  ModeMatrix transition;  ///< Pi (r x r), rows sum to 1
  ModeVector initial;     ///< (r), sums to 1
  double period_s = 1.0;  ///< that Pi belongs to, > 0

  int modes() const { return static_cast<int>(initial.size()); }

  /// Pi over dt_s. At another dt than the period a mode is kept with Pi_ii^(dt / period), the sojourn time that the
  /// chain has in continuous time, and left for the others in the proportions of Pi.
  ModeMatrix over(double dt_s) const {
    if (dt_s == period_s) return transition;
    ModeMatrix Pi = transition;
    for (Eigen::Index i = 0; i < Pi.rows(); ++i) {
      const double stay = std::pow(transition(i, i), dt_s / period_s);
      const double leave = 1.0 - transition(i, i);
      if (leave > 0.0) Pi.row(i) *= (1.0 - stay) / leave;
      Pi(i, i) = stay;
    }
    return Pi;
  }
};

/// Mode 0 is left with probability `leave_first` a period, evenly for the others; any other mode with `leave_other`, a
/// share `to_first` of it for mode 0 and the rest evenly. modes >= 2; the modes begin equally likely.
inline MarkovChain star_chain(int modes, double leave_first, double leave_other, double to_first, double period_s) {
  const double others = modes - 1.0;
  MarkovChain chain;
  chain.period_s = period_s;
  chain.initial = ModeVector::Constant(modes, 1.0 / modes);
  chain.transition =
      ModeMatrix::Constant(modes, modes, modes > 2 ? leave_other * (1.0 - to_first) / (others - 1.0) : 0.0);
  chain.transition.row(0).setConstant(leave_first / others);
  chain.transition.col(0).setConstant(modes > 2 ? leave_other * to_first : leave_other);
  chain.transition.diagonal().setConstant(1.0 - leave_other);
  chain.transition(0, 0) = 1.0 - leave_first;
  return chain;
}

}  // namespace truebearing
