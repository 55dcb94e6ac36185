// SPDX-License-Identifier: Apache-2.0
// The GOSPA (gospa.hpp) of targets that appear and vanish, over the scored steps of a tracker's runs. Key
// of [scoring]; it does not go with `tracks`, which tells tracks by their numbers:
//   gospa = { quantity = "angle_deg", cutoff = 5.0 }
#pragma once

#include <memory>

#include "truebearing/evaluation/metric_family.hpp"

namespace truebearing {

/// Summed over the scored steps of a run.
struct GospaFigures : StepFigures {
  double squared = 0.0;
  double localisation = 0.0;
  double missed = 0.0;
  double false_tracks = 0.0;
  double steps = 0.0;
};

/// With the assignment of the rule; nothing of a tracker that does not estimate its quantity.
///   gospa, gospa_localisation     root of the mean over runs and scored steps of its square; of the assigned pairs'
///                                 part
///   missed_targets, false_tracks  mean number per scored step
std::shared_ptr<const MetricFamily> gospa_metrics();

}  // namespace truebearing
