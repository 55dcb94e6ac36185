// SPDX-License-Identifier: Apache-2.0
// A comparison of trackers of two targets, of which one is near, one is nearer, and one has swapped its tracks.
#pragma once

#include "tests/support/angle_tracks.hpp"
#include "truebearing/evaluation/comparison.hpp"

namespace truebearing::testing {

inline Comparison angle_comparison(const ScoringRule& rule) {
  Recording recording = angle_recording({{0, {0, 0, 0, 0}}, {1, {20, 20, 20, 20}}});
  recording.phases = {"apart", "crossing"};
  recording.truth[0].phase = {0, 0, 1, 1};
  recording.truth[1].phase = {0, 1, 1, 1};
  Ensemble ensemble;
  ensemble.add("near", told_tracker(AnglesOfTracks{{0, {1, 1, 1, 1}}, {1, {20, 20, 20, 20}}}));
  ensemble.add("nearer", told_tracker(AnglesOfTracks{{0, {0, 0, 0.5, 0.5}}, {1, {20, 20, 20, 20}}}));
  ensemble.add("swapped", told_tracker(AnglesOfTracks{{0, {0, 0, 20, 20}}, {1, {20, 20, 0, 0}}}));
  TrackerSet set(std::move(ensemble));
  for (const char* name : {"near", "nearer", "swapped"}) set.show_member(name);
  ComparisonOptions options;
  options.runs = 3;
  options.scoring = rule;
  options.pairs = {{"nearer", "near"}};
  const FakeScenario scenario(recording);
  return compare(set, {{"two", &scenario}}, options);
}

}  // namespace truebearing::testing
