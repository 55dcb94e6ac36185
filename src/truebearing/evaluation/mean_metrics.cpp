// SPDX-License-Identifier: Apache-2.0
// The error's mean and mean square. Key of [scoring]: mean_error = true. With each quantity,
//   <quantity>_mean_error  mean of the error norm over runs, scored steps and targets
//   <quantity>_mse         mean of its square
// with the jackknife over runs for their standard errors.
#include <cmath>
#include <string>
#include <vector>

#include "truebearing/evaluation/metric_registry.hpp"
#include "truebearing/evaluation/run_score.hpp"
#include "truebearing/evaluation/samples.hpp"
#include "truebearing/evaluation/summary.hpp"

namespace truebearing {
namespace {

class MeanTally final : public MetricTally {
 public:
  explicit MeanTally(const Scorer& scorer)
      : quantities_(scorer.quantities()), roots_(quantities_.size()), errors_(quantities_.size()) {}

  void add(const RunScore& run) override {
    for (std::size_t q = 0; q < quantities_.size(); ++q) {
      SquaredErrors roots;  // the mean square of the roots is the mean
      for (const double error : run.error[q])
        if (!std::isnan(error)) roots.add(std::sqrt(error));
      roots_[q].add(roots);
      errors_[q].add(squared_errors(run, q));
    }
  }

  void exchange(TallyStream& stream) override {
    for (RunErrors& roots : roots_) roots.exchange(stream);
    for (RunErrors& errors : errors_) errors.exchange(stream);
  }

  std::vector<Metric> metrics() const override {
    std::vector<Metric> metrics;
    for (std::size_t q = 0; q < quantities_.size(); ++q) {
      const Estimate mean = roots_[q].mse(), square = errors_[q].mse();
      const std::string name = name_of(quantities_[q]);
      metrics.push_back({name + "_mean_error", unit_of(quantities_[q]), std::nullopt, mean.value, mean.se});
      metrics.push_back({name + "_mse", squared_unit_of(quantities_[q]), std::nullopt, square.value, square.se});
    }
    return metrics;
  }

 private:
  std::vector<std::string> quantities_;
  std::vector<RunErrors> roots_, errors_;  // [quantity]
};

class MeanMetrics final : public MetricFamily {
 public:
  std::unique_ptr<MetricTally> tally(const ScoringRule&, const Scorer& scorer) const override {
    return std::make_unique<MeanTally>(scorer);
  }
};

}  // namespace

std::shared_ptr<const MetricFamily> read_mean_error(TableReader& scoring, const StateSpace&, ScoringRule&) {
  return scoring.boolean_or("mean_error", false) ? std::make_shared<MeanMetrics>() : nullptr;
}

}  // namespace truebearing
