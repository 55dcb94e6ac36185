// SPDX-License-Identifier: Apache-2.0
// A belief about a target's range and velocity from its table in a study: what trackers start from, batch estimators
// weigh in, and posterior bounds assume.
#pragma once

#include "truebearing/io/table_reader.hpp"
#include "truebearing/tma/range_prior.hpp"
#include "truebearing/tracker/range_hypotheses.hpp"

namespace truebearing {

/// { kind = "range", ... } with
///     range_m, range_sigma_m            of the range, unless the measurement carries a guess; or
///     guess = true                      the measurements carry one, and without it nothing starts
///     between_m = [low, high]           where the ranges of a family lie: a matched start
///     velocity_sigma_mps                per axis about zero; or
///     course = { from_bearing_deg, sigma_deg, speed_mps, speed_sigma_mps }   the last two not beside guess = true
///     climb_sigma_mps                   of a target in space, where dimensions is 3
/// Asks for all keys of `table` and finishes it.
RangePrior read_range_prior(TableReader table, int dimensions = 2);

/// Of a bank of filters on that belief: start, ranges, velocity_cells, speed_between_mps, least_range_m.
RangeHypotheses read_range_hypotheses(TableReader& tracker, int dimensions = 2);

}  // namespace truebearing
