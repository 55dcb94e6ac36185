// SPDX-License-Identifier: Apache-2.0
// What metric families are given, by hand: for their tests.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "truebearing/evaluation/run_score.hpp"

namespace truebearing::testing {

inline std::vector<const RunScore*> pointers(const std::vector<RunScore>& runs) {
  std::vector<const RunScore*> all;
  for (const RunScore& score : runs) all.push_back(&score);
  return all;
}

/// The family's figures of these runs.
inline std::vector<Metric> figures(const MetricFamily& family, const Scorer& scorer, const std::vector<RunScore>& runs,
                                   const ScoringRule& rule = {}) {
  const std::unique_ptr<MetricTally> tally = family.tally(rule, scorer);
  for (const RunScore& run : runs) tally->add(run);
  return tally->metrics();
}

/// The same of runs of two trackers with the same state: a - b.
inline std::vector<PairedDifference> paired(const MetricFamily& family, const Scorer& scorer,
                                            const std::vector<RunScore>& a, const std::vector<RunScore>& b,
                                            const ScoringRule& rule = {}) {
  const std::unique_ptr<PairTally> tally = family.pair_tally(rule, scorer, scorer);
  for (std::size_t run = 0; run < a.size(); ++run) tally->add(a[run], b[run]);
  return tally->differences();
}

inline bool has_metric(const std::vector<Metric>& metrics, const std::string& name) {
  for (const Metric& metric : metrics)
    if (metric.name == name) return true;
  return false;
}

/// That metric at that time, or the one without a time.
inline Metric find_metric(const std::vector<Metric>& metrics, const std::string& name,
                          std::optional<double> time_s = std::nullopt) {
  for (const Metric& metric : metrics)
    if (metric.name == name && metric.time_s == time_s) return metric;
  ADD_FAILURE() << "no metric " << name;
  return {};
}

}  // namespace truebearing::testing
