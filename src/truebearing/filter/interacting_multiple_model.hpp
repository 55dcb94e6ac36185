// SPDX-License-Identifier: Apache-2.0
// The interacting multiple model estimator (Blom and Bar-Shalom 1988; Bar-Shalom, Li and Kirubarajan 2001, sec.
// 11.6.6): r filters under one motion model each, mixed before every prediction by the chain that says how targets
// change from one to another, weighted by the likelihood of their innovations.
//     mixing     c_j = sum_i Pi_ij mu_i,  mu_i|j = Pi_ij mu_i / c_j,
//                x_0j = sum_i mu_i|j x_i,  P_0j = sum_i mu_i|j (P_i + (x_i - x_0j)(x_i - x_0j)')
//     weighting  mu_j ~ c_j N(nu_j; 0, S_j)
// The filters themselves are a ModeBank.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>

#include "truebearing/core/bounded.hpp"
#include "truebearing/filter/markov_chain.hpp"
#include "truebearing/filter/mode_bank.hpp"
#include "truebearing/filter/tracked_state.hpp"

namespace truebearing {

class InteractingMultipleModel final : public TrackedState {
 public:
  using Modes = ModeBank::Modes;

  /// `modes` (r, 1 to kMaxModes), each a filter under one motion, and a chain of as many. Begun at zero.
  InteractingMultipleModel(Modes modes, MarkovChain chain);

  /// Every mode begins with (x, P), or as much of it as its state has.
  void begin(const double* x, const double* P) override;
  /// Mixes, then crosses dt_s seconds in every mode.
  StepStatus predict(double dt_s) override;
  /// nu and S are those of the mixture of the modes' predictions, K the probability-weighted gain of the modes. A mode
  /// whose arithmetic fails, where others' does not, has lost; `failed` where all have.
  StepStatus update(const AnyMeasurement& measurement, const StateUpdateTarget& update) override;
  void assign(const TrackedState& other) override;
  std::unique_ptr<TrackedState> fresh() const override;
  std::span<const std::unique_ptr<TrackedState>> modes() const override { return modes_->modes(); }
  ModeMatrix transition(double dt_s) const override { return chain_.over(dt_s); }
  const MarkovChain& chain() const { return chain_; }

  // To become what was worked out elsewhere (state_pack.hpp): every mode, then mu (r).
  void begin_mode(int mode, const double* x, const double* P) { modes_->begin_mode(mode, x, P); }
  void believe(const ModeVector& mu);

 private:
  InteractingMultipleModel(int size, std::unique_ptr<ModeBank> modes, const MarkovChain& chain);
  void set_up();
  void refresh() const override;

  std::unique_ptr<ModeBank> modes_;
  MarkovChain chain_;
  ModeVector probabilities_;  // mu
  ModeVector predicted_;      // c of the last prediction
  ModeMatrix over_dt_;        // Pi over the last interval that was not the period of the chain
  // Mean and covariance of the mixture.
  mutable BoundedVector x_;
  mutable BoundedMatrix P_;
};

}  // namespace truebearing
