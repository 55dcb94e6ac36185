// SPDX-License-Identifier: Apache-2.0
// What plots need of a tracker beside its figures: the error of each run, and how well the errors of each step are known
// and believed. Kept only where a comparison is asked for it.
#pragma once

#include <cstddef>
#include <vector>

#include "truebearing/evaluation/run_score.hpp"
#include "truebearing/evaluation/statistics.hpp"

namespace truebearing {

struct TrackerDetails {
  std::vector<std::vector<double>> run_rmse;   ///< [quantity][run]; NaN where nothing was scored
  std::vector<std::vector<double>> series_se;  ///< [quantity][step]: standard error of the RMSE of that step, over runs
  std::vector<double> nees;                    ///< [step]: mean over runs and targets; NaN where not scored
  std::vector<double> nees_low, nees_high;     ///< [step]: where 95 % of such means lie if the tracker is consistent
};

/// Takes the runs of one tracker in the order of their numbers.
class DetailsTally {
 public:
  /// dimension: the expected NEES.
  explicit DetailsTally(int dimension) : dimension_(dimension) {}
  void add(const RunScore& run);
  void exchange(TallyStream& stream);
  TrackerDetails details() const;

 private:
  // Of one quantity at one step: the mean square over a run's targets, its sum over runs and that of its square.
  struct StepMoments {
    double sum = 0.0, squares = 0.0, runs = 0.0;
    double rmse_se() const;
  };
  void add_errors(const RunScore& run, std::size_t quantity);

  int dimension_;
  std::vector<std::vector<double>> run_rmse_;
  std::vector<std::vector<StepMoments>> steps_;  // [quantity][step]
  struct Nees {
    double sum = 0.0, count = 0.0;
  };
  std::vector<Nees> nees_;  // [step]
};

}  // namespace truebearing
