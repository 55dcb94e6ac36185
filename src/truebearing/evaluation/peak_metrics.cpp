// SPDX-License-Identifier: Apache-2.0
// How far a tracker strays at worst. Key of [scoring]: peak_error = true. With each quantity,
//   <quantity>_peak_error  mean over runs of the largest error norm among a run's scored steps and targets; runs
//                          without any are left out
#include <cmath>
#include <string>
#include <vector>

#include "truebearing/evaluation/metric_registry.hpp"
#include "truebearing/evaluation/run_score.hpp"
#include "truebearing/evaluation/samples.hpp"

namespace truebearing {
namespace {

class PeakTally final : public MetricTally {
 public:
  explicit PeakTally(const Scorer& scorer) : quantities_(scorer.quantities()), peaks_(quantities_.size()) {}

  void add(const RunScore& run) override {
    for (std::size_t q = 0; q < quantities_.size(); ++q) {
      double peak = std::nan("");
      for (const double error : run.error[q]) peak = std::fmax(peak, error);
      if (std::isfinite(peak)) peaks_[q].add(peak);
    }
  }

  void exchange(TallyStream& stream) override {
    for (Samples& peaks : peaks_) peaks.exchange(stream);
  }

  std::vector<Metric> metrics() const override {
    std::vector<Metric> metrics;
    for (std::size_t q = 0; q < quantities_.size(); ++q) {
      const Estimate mean = peaks_[q].mean();
      metrics.push_back(
          {name_of(quantities_[q]) + "_peak_error", unit_of(quantities_[q]), std::nullopt, mean.value, mean.se});
    }
    return metrics;
  }

 private:
  std::vector<std::string> quantities_;
  std::vector<Samples> peaks_;  // [quantity]
};

class PeakMetrics final : public MetricFamily {
 public:
  std::unique_ptr<MetricTally> tally(const ScoringRule&, const Scorer& scorer) const override {
    return std::make_unique<PeakTally>(scorer);
  }
};

}  // namespace

std::shared_ptr<const MetricFamily> read_peak_error(TableReader& scoring, const StateSpace&, ScoringRule&) {
  return scoring.boolean_or("peak_error", false) ? std::make_shared<PeakMetrics>() : nullptr;
}

}  // namespace truebearing
