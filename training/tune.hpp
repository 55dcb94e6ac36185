// SPDX-License-Identifier: Apache-2.0
// Tuning the baselines: the numbers that a study names under `tune` (Q, R, P0, ...) fitted to training draws, so that a
// correction is compared with the best that its filter can do. Minimises the sum over scored quantities of ln RMSE.
#pragma once

#include <string>

#include "truebearing/evaluation/ranks.hpp"
#include "truebearing/study/parameters_file.hpp"
#include "truebearing/study/study.hpp"

namespace truebearing {

struct TuneOptions {
  std::uint64_t seed = 1;
  int threads = 0;
  int max_evaluations = 600;  ///< of the search, in two rounds of half as many; the numbers as they are come before it
  /// Called with (evaluations done, at most, best cost so far); may be empty.
  std::function<void(int, int, double)> progress;
  Ranks* ranks = nullptr;  ///< share the runs of each evaluation; all of them find the same numbers
};

struct TuneReport {
  int evaluations = 0;
  double cost_before = 0.0;  ///< sum of ln RMSE with the numbers as the study has them
  double cost_after = 0.0;
};

/// Fits tracker `name` on study.tuning_runs() runs of the role `tuning`. All numbers are positive and move in their
/// logarithms, by Nelder and Mead's simplex with restarts (NLopt). Where multiplying all of them by one factor leaves
/// the estimates as they are (Q, R and P0 of a Kalman filter), the factor is set so that the mean NEES is the dimension
/// of the state. Throws InputError, also where the ranks' machines do not round alike.
TunedValues tune_tracker(const Study& study, const std::string& name, const TuneOptions& options,
                         TuneReport* report = nullptr);

}  // namespace truebearing
