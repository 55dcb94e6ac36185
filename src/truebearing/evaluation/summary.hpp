// SPDX-License-Identifier: Apache-2.0
// The figures that a comparison reports, from the scores of its runs. Definitions, as docs/metrics.md has them:
// `rmse` over runs and scored steps, `rmse_se` by the jackknife over runs, `paired` over runs.
#pragma once

#include <string>
#include <vector>

#include "truebearing/evaluation/metric.hpp"
#include "truebearing/evaluation/run_score.hpp"
#include "truebearing/evaluation/samples.hpp"

namespace truebearing {

struct QuantitySummary {
  std::string name;
  double rmse = 0.0;
  double rmse_se = 0.0;        ///< jackknife over runs; NaN for a single run
  double median = 0.0;         ///< of the error norm over runs and scored steps
  double coverage95 = 0.0;     ///< share of them inside the 95 % ellipse of the quantity's own covariance
  std::vector<double> series;  ///< RMSE over runs and targets at each step; NaN where not scored
  struct Phase {
    double rmse = 0.0;
    double rmse_se = 0.0;
  };
  std::vector<Phase> phases;  ///< over the steps of each phase; empty where the recordings tell none
};

struct TrackerSummary {
  std::string name;
  std::vector<QuantitySummary> quantities;
  int dimension = 0;        ///< the expected NEES
  double nees = 0.0;        ///< mean over runs and scored steps
  double coverage95 = 0.0;  ///< share of them under the 95 % chi-square quantile
  double loss_rate = 0.0;
  long scored_steps = 0;
  long corrected_steps = 0;     ///< of a corrected tracker, else 0
  double limited_share = 0.0;   ///< share of the corrected steps that kappa limited
  double mean_gate = 0.0;       ///< mean weight of the gate over the corrected steps
  std::vector<Metric> metrics;  ///< figures at given times, and what else a problem has

  const QuantitySummary* quantity(const std::string& quantity_name) const;
};

/// The runs of one tracker, added in the order of their numbers, and gone afterwards.
class SummaryTally {
 public:
  /// The scorer and the rule must outlive it. kept_apart: how many errors of a quantity are kept for its median
  /// (samples.hpp).
  SummaryTally(std::string name, const Scorer& scorer, const ScoringRule& rule,
               std::size_t kept_apart = kMostValuesApart);
  void add(const RunScore& run);
  void exchange(TallyStream& stream);
  TrackerSummary summary() const;

 private:
  struct QuantityTally {
    explicit QuantityTally(std::size_t kept_apart) : median(kept_apart) {}
    /// Gives the errors of the run.
    SquaredErrors add(const RunScore& run, std::size_t quantity, std::size_t phases_of_run, double nees95);
    void exchange(TallyStream& stream);

    RunErrors runs;
    MedianOf median;
    std::vector<SquaredErrors> steps;
    std::vector<RunErrors> phases;
    double covered = 0.0;
    double count = 0.0;
  };
  void add_consistency(const RunScore& run);

  std::string name_;
  const Scorer& scorer_;
  const ScoringRule& rule_;
  std::vector<QuantityTally> quantities_;
  double nees_sum_ = 0.0, covered_ = 0.0, count_ = 0.0, gate_sum_ = 0.0, limited_ = 0.0, lost_ = 0.0, runs_ = 0.0;
  long scored_steps_ = 0;
  long corrected_steps_ = 0;
};

/// a - b of the RMSE of two trackers over the same runs, for the quantities that both have; runs as above.
class DifferenceTally {
 public:
  DifferenceTally(const Scorer& a, const Scorer& b);
  void add(const RunScore& a, const RunScore& b);
  void exchange(TallyStream& stream);
  std::vector<PairedDifference> differences() const;

 private:
  struct Compared {
    std::string name;
    std::size_t in_a, in_b;
    Samples differences;
  };
  std::vector<Compared> quantities_;
};

/// The same of all runs at once. scores: [run], of one tracker.
TrackerSummary summarise(const std::string& name, const Scorer& scorer, const std::vector<const RunScore*>& scores,
                         const ScoringRule& rule);

/// The squared errors of a run's scored steps, of all its targets; those of one phase.
SquaredErrors squared_errors(const RunScore& score, std::size_t quantity);
SquaredErrors squared_errors_in(const RunScore& score, std::size_t quantity, int phase);
/// How many phases the runs tell apart.
int phase_count(const std::vector<const RunScore*>& scores);

/// DifferenceTally of all runs at once.
std::vector<PairedDifference> paired_difference(const Scorer& scorer_a, const std::vector<const RunScore*>& a,
                                                const Scorer& scorer_b, const std::vector<const RunScore*>& b);

}  // namespace truebearing
