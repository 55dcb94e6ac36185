// How far a tracker strays at worst. Key of [scoring]: peak_error = true. With each quantity,
//   <quantity>_peak_error  mean over runs of the largest error norm among a run's scored steps and targets; runs
//                          without any are left out
#include <algorithm>
#include <cmath>

#include "truebearing/evaluation/metric_registry.hpp"
#include "truebearing/evaluation/statistics.hpp"

namespace truebearing {
namespace {

class PeakMetrics final : public MetricFamily {
 public:
  std::vector<Metric> finish(const TrackerRuns& runs) const override {
    std::vector<Metric> metrics;
    for (std::size_t q = 0; q < runs.scorer.quantities().size(); ++q) {
      std::vector<double> peaks;
      for (const RunScore* run : runs.scores) {
        double peak = std::nan("");
        for (const double error : run->error[q]) peak = std::fmax(peak, error);
        if (std::isfinite(peak)) peaks.push_back(peak);
      }
      const std::string& quantity = runs.scorer.quantities()[q];
      const Estimate mean = mean_of(peaks);
      metrics.push_back({name_of(quantity) + "_peak_error", unit_of(quantity), std::nullopt, mean.value, mean.se});
    }
    return metrics;
  }
};

}  // namespace

std::shared_ptr<const MetricFamily> read_peak_error(TableReader& scoring, const StateSpace&, ScoringRule&) {
  return scoring.boolean_or("peak_error", false) ? std::make_shared<PeakMetrics>() : nullptr;
}

}  // namespace truebearing
