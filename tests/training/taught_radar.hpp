// SPDX-License-Identifier: Apache-2.0
// An ensemble of two filters of the 1-D radar and a correction of it, for tests of what a teacher makes of them.
#pragma once

#include <cstddef>

#include "tests/support/correction_models.hpp"
#include "tests/support/line_trackers.hpp"
#include "training/teacher.hpp"

namespace truebearing::testing {

inline Ensemble taught_ensemble() {
  Ensemble made;
  RadarFilter radar;
  made.add("plain", radar.tracker());
  radar.variance = {1e6, 5e4};
  made.add("wide", radar.tracker());
  return made;
}

inline CorrectionSpec taught_correction(std::size_t runs) {
  CorrectionSpec made;
  made.design.base = made.design.reference = "plain";
  made.design.covariance_of = "wide";
  made.design.features = radar_features();
  made.training.runs = runs;
  return made;
}

}  // namespace truebearing::testing
