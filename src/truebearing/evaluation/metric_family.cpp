// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/metric_family.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "truebearing/evaluation/run_score.hpp"

namespace truebearing {

MetricTallies::MetricTallies(const ScoringRule& rule, const Scorer& scorer) {
  for (const std::shared_ptr<const MetricFamily>& family : rule.families)
    tallies_.push_back(family->tally(rule, scorer));
}

void MetricTallies::add(const RunScore& run) {
  for (const std::unique_ptr<MetricTally>& tally : tallies_) tally->add(run);
}

void MetricTallies::exchange(TallyStream& stream) {
  for (const std::unique_ptr<MetricTally>& tally : tallies_) tally->exchange(stream);
}

std::vector<Metric> MetricTallies::metrics() const {
  std::vector<Metric> metrics;
  for (const std::unique_ptr<MetricTally>& tally : tallies_)
    for (Metric& metric : tally->metrics()) metrics.push_back(std::move(metric));
  const auto place = [](const Metric& metric) {
    return metric.time_s.value_or(std::numeric_limits<double>::infinity());
  };
  std::stable_sort(metrics.begin(), metrics.end(),
                   [&](const Metric& a, const Metric& b) { return place(a) < place(b); });
  return metrics;
}

PairTallies::PairTallies(const ScoringRule& rule, const Scorer& a, const Scorer& b) {
  for (const std::shared_ptr<const MetricFamily>& family : rule.families)
    if (auto tally = family->pair_tally(rule, a, b)) tallies_.push_back(std::move(tally));
}

void PairTallies::add(const RunScore& a, const RunScore& b) {
  for (const std::unique_ptr<PairTally>& tally : tallies_) tally->add(a, b);
}

void PairTallies::exchange(TallyStream& stream) {
  for (const std::unique_ptr<PairTally>& tally : tallies_) tally->exchange(stream);
}

std::vector<PairedDifference> PairTallies::differences() const {
  std::vector<PairedDifference> differences;
  for (const std::unique_ptr<PairTally>& tally : tallies_)
    for (PairedDifference& difference : tally->differences()) differences.push_back(std::move(difference));
  return differences;
}

}  // namespace truebearing
