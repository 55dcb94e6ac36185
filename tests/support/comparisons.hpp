// SPDX-License-Identifier: Apache-2.0
// Comparisons of a study's own trackers for acceptance tests.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "truebearing/study/study.hpp"

namespace truebearing::testing {

inline Study load_study(const std::string& name) {
  return Study::load(std::string(TRUEBEARING_SOURCE_DIR "/data/studies/") + name + ".toml");
}

/// Some of a study's trackers, none of them corrected.
inline Comparison run_members(const Study& study, const std::vector<std::string>& names, std::size_t runs) {
  TrackerSet trackers(study.make_ensemble(names));
  for (const std::string& name : names) trackers.show_member(name);
  ComparisonOptions options = study.comparison_options();
  options.runs = runs;
  options.seed = 20;
  options.pairs.clear();
  return compare(trackers, study.evaluation_scenarios(), options);
}

/// That metric of that tracker at that time, or one without a time.
inline Metric metric(const Comparison& comparison, const std::string& tracker, const std::string& name, double time_s) {
  for (const Metric& entry : comparison.tracker(tracker)->metrics)
    if (entry.name == name && (!entry.time_s || *entry.time_s == time_s)) return entry;
  ADD_FAILURE() << tracker << " has no " << name << " at " << time_s;
  return {};
}

/// What a - b is in that quantity, over all times; a failure where the comparison has no such pair.
inline PairedDifference difference(const Comparison& comparison, const std::string& a, const std::string& b,
                                   const std::string& quantity) {
  for (const Comparison::Pair& pair : comparison.pairs)
    for (const PairedDifference& found : pair.differences)
      if (pair.a == a && pair.b == b && found.quantity == quantity && !found.time_s) return found;
  ADD_FAILURE() << "there is no " << a << " - " << b << " in " << quantity;
  return {};
}

/// a is better than b in that quantity by more than two standard errors of the paired difference.
inline void expect_better(const Comparison& comparison, const std::string& a, const std::string& b,
                          const std::string& quantity) {
  const PairedDifference found = difference(comparison, a, b, quantity);
  EXPECT_LT(found.mean + 2.0 * found.se, 0.0) << a << " - " << b << ", " << quantity;
}

/// a is at most `margin` worse than b in that quantity, up to two standard errors of the paired difference.
inline void expect_no_worse(const Comparison& comparison, const std::string& a, const std::string& b,
                            const std::string& quantity, double margin = 0.0) {
  const PairedDifference found = difference(comparison, a, b, quantity);
  EXPECT_LT(found.mean - 2.0 * found.se, margin) << a << " - " << b << ", " << quantity;
}

}  // namespace truebearing::testing
