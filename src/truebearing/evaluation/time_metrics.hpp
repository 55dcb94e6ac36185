// SPDX-License-Identifier: Apache-2.0
// Figures at the times of a scoring rule, from the scores of a tracker's runs. Their names and definitions are those of
// docs/metrics.md. A run counts at a time that it reaches with a known truth; of these, runs without a finite estimate are
// left out of every figure but `missing_share`, where they are counted, and `loss_rate`, where they are lost.
#pragma once

#include <memory>

#include "truebearing/evaluation/metric_family.hpp"

namespace truebearing {

/// QUANTITY_rmse and _median, nees, coverage95, missing_share, and loss_rate where the rule says what lost is.
/// Paired: of each quantity at each time, the difference of the error norms, over the runs in which both have an
/// estimate.
std::shared_ptr<const MetricFamily> time_metrics();

}  // namespace truebearing
