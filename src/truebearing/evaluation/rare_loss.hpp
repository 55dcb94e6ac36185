// SPDX-License-Identifier: Apache-2.0
// How often a tracker loses its target where that is so rare that plain runs would take days: multilevel splitting over
// whole runs (subset simulation, Au and Beck 2001).
//
// A run is a function of its random words. Its score s is the largest last error in units of the loss threshold
// (loss_score.hpp): the run is lost where s > 1. With levels b_1 < ... < b_m = 1,
//
//   P(s > 1) = P(s > b_1) P(s > b_2 | s > b_1) ... P(s > 1 | s > b_{m-1})
//
// of which no factor is rare. Each is the share S / N of N runs; the next level's N runs are chains from the S, of N /
// S runs each (one more by lot, so that they are N), of moved words (run_words.hpp) that are taken where the run is
// still beyond the level (conditional sampling: Papaioannou, Betz, Zwirglmaier and Straub 2015). Any scenario and any
// tracker will do, smoothers and corrections too.
//
// A pilot finds the levels, a tenth of its runs beyond each, and the size of the moves at each, 44 % of them taken. Its
// own estimate is biased by having chosen, and is not used. The repetitions after it have these fixed, so that the
// product of their shares is an unbiased estimate each, however badly the chains mix and whatever the pilot found (Del
// Moral 2004, theorem 7.4.2), and they are independent: the mean over them is the figure, their spread its standard
// error.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "truebearing/evaluation/monte_carlo.hpp"
#include "truebearing/evaluation/run_score.hpp"
#include "truebearing/evaluation/statistics.hpp"
#include "truebearing/simulation/scenario.hpp"

namespace truebearing {

struct RareLossOptions {
  std::uint64_t seed = 1;
  std::size_t draws = 2000;      ///< runs of a level, 20 or more
  std::size_t repetitions = 20;  ///< 2 or more
  int threads = 0;               ///< 0: one per core; more than the repetitions have nothing to do
  Progress progress;  ///< of levels of the pilot and the repetitions; their number grows while the pilot climbs
};

struct RareLoss {
  /// How often the largest last error is beyond `score` times its threshold.
  struct Level {
    double score;
    Estimate probability;
    double taken;  ///< share of the moves that led there and were taken, over the repetitions; NaN of the first
  };
  std::vector<Level> levels;        ///< ascending; the last is 1
  Estimate loss_rate{0.0, 0.0};     ///< of the last
  std::vector<double> repetitions;  ///< the loss rate of each
  std::size_t runs = 0;             ///< that were computed, the pilot's too
};

/// Of the only tracker of the set. The same for any number of threads, and of other runs than any comparison's. Throws
/// InputError where the rule has no threshold of a quantity of the tracker, where the runs of the scenario do not
/// differ, and where the pilot does not get there: where losses are rarer than 1e-12, or too few runs are beyond a
/// level.
RareLoss rare_loss(const TrackerSet& tracker, const Scenario& scenario, const ScoringRule& rule,
                   const RareLossOptions& options);

}  // namespace truebearing
