// SPDX-License-Identifier: Apache-2.0
// One step of a smoother, backwards: from the smoothed estimate at a later time and the filter's at an earlier one to
// the smoothed estimate there. Of a single filter that of Rauch, Tung and Striebel (1965), of an extended or an unscented
// one with its own cross-covariance (Sarkka 2008):
//     G = C P_pred^-1,  C = Cov(x, x+),  x_s = x + G (x_s+ - x_pred),  P_s = P + G (P_s+ - P_pred) G'
// Of a multiple model, for each pair of a mode i and the mode j that follows it: what the future says of x+ under j is the
// ratio L_j(x+) = N(x+; x_s+j, P_s+j) / N(x+; x_pred j, P_pred j), the two-filter form of Helmick, Blair and Hoffman
// (1995) without a filter that runs backwards. Then
//     w_ij ~ mu_s+j mu_i|j \int N(x+; x_pred ij, P_pred ij) L_j(x+) dx+,  sum_i w_ij = mu_s+j,
//     N_ij = N(x+; x_pred ij, P_pred ij) L_j(x+), normalised, and from it the step above under the motion of j,
// and mode i is what its pairs are together: mu_s i = sum_j w_ij. mu_i|j, x_pred j and P_pred j are the filter's own,
// with its mixing (interacting_multiple_model.hpp).
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "truebearing/core/bounded.hpp"
#include "truebearing/filter/tracked_state.hpp"

namespace truebearing {

struct ModeEstimate {
  BoundedVector x;  ///< (n_i)
  BoundedMatrix P;  ///< (n_i x n_i)
};

/// What a tracked state believes, mode by mode; a single filter is one mode.
struct ModeEstimates {
  std::vector<ModeEstimate> modes;  ///< (r)
  ModeVector mu;                    ///< (r)
};

ModeEstimates estimates_of(const TrackedState& state);

/// Mean and covariance of the mixture; what a mode's state lacks is zero in it, as in the filter's.
ModeEstimate mixture_of(const ModeEstimates& estimates);

class BackwardStep {
 public:
  /// Of states like this one: under its motions, and its chain.
  explicit BackwardStep(const TrackedState& state);

  /// The filter's prediction of an estimate over dt_s; nothing where that fails.
  std::optional<ModeEstimates> predicted(const ModeEstimates& filtered, double dt_s);

  /// The smoothed estimate where the filter's was `filtered`, from the smoothed one dt_s later. Over no time they are the
  /// same. widened: factor on P_pred, by which a gate let a measurement pass. Nothing where the arithmetic fails or a
  /// mode's covariance came out as none.
  std::optional<ModeEstimates> smoothed(const ModeEstimates& filtered, double dt_s, const ModeEstimates& next,
                                        double widened = 1.0);

 private:
  struct Crossing {
    ModeEstimate predicted;
    BoundedMatrix C;
  };

  std::size_t modes() const { return scratch_.size(); }
  std::optional<ModeEstimates> smoothed_together(const ModeEstimates& filtered, double dt_s, const ModeEstimates& next);
  std::optional<Crossing> cross(std::size_t mode, const ModeEstimate& estimate, double dt_s);

  std::unique_ptr<TrackedState> chain_;                 // asked for its transitions
  std::vector<std::unique_ptr<TrackedState>> scratch_;  // (r), one filter each
};

}  // namespace truebearing
