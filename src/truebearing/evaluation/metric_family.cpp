#include "truebearing/evaluation/metric_family.hpp"

#include <algorithm>
#include <limits>

#include "truebearing/evaluation/run_score.hpp"

namespace truebearing {

std::vector<Metric> metrics_of(const TrackerRuns& runs) {
  std::vector<Metric> metrics;
  for (const std::shared_ptr<const MetricFamily>& family : runs.rule.families)
    for (Metric& metric : family->finish(runs)) metrics.push_back(std::move(metric));
  const auto place = [](const Metric& metric) {
    return metric.time_s.value_or(std::numeric_limits<double>::infinity());
  };
  std::stable_sort(metrics.begin(), metrics.end(),
                   [&](const Metric& a, const Metric& b) { return place(a) < place(b); });
  return metrics;
}

std::vector<PairedDifference> paired_differences(const TrackerRuns& a, const TrackerRuns& b) {
  std::vector<PairedDifference> differences;
  for (const std::shared_ptr<const MetricFamily>& family : a.rule.families)
    for (PairedDifference& difference : family->paired(a, b)) differences.push_back(std::move(difference));
  return differences;
}

}  // namespace truebearing
