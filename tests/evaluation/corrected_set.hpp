// SPDX-License-Identifier: Apache-2.0
// Trackers of the radar on the line with a correction that its gate and kappa limit, for tests of comparisons.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "tests/support/correction_models.hpp"
#include "tests/support/line_trackers.hpp"
#include "truebearing/evaluation/tracker_set.hpp"

namespace truebearing::testing {

inline Ensemble radar_ensemble() {
  Ensemble ensemble;
  RadarFilter radar;
  ensemble.add("plain", radar.tracker());
  radar.variance = {1e6, 5e4};
  ensemble.add("wide", radar.tracker());
  radar.sigma_m = 4000.0;
  ensemble.add("tuned", radar.tracker());
  return ensemble;
}

/// Shows those of plain, wide and tuned, and behind them the correction nfnn.
inline TrackerSet corrected_set(const std::vector<std::string>& shown) {
  TrackerSet set(radar_ensemble());
  for (const std::string& name : shown) set.show_member(name);
  RandomStream random({}, StreamId::test);
  CorrectionModel model = line_model(radar_features(), random_parameters(random, 4, 6, 2), "plain", "tuned", "wide");
  model.gate = box(4, -2.0, 2.0, 3.0);  // ln step leaves it at the eighth
  set.show_correction("nfnn", shared(model), {.kappa = 0.5});
  return set;
}

}  // namespace truebearing::testing
