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

}  // namespace truebearing::testing
