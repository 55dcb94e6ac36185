// SPDX-License-Identifier: Apache-2.0
// What the makers of filter trackers share: starts, options, the chain between modes.
#pragma once

#include "truebearing/filter/markov_chain.hpp"
#include "truebearing/io/table_reader.hpp"
#include "truebearing/study/measurement_kinds.hpp"
#include "truebearing/study/motion_kinds.hpp"
#include "truebearing/tracker/filter_tracker.hpp"

namespace truebearing {

/// What the state of a motion has where that is measured; frequency_q_hz2ps.
MotionLayout read_layout(TableReader& tracker, const MeasurementChoice& measurement);

/// start = { kind = "prior" | "one_point" | "two_point" | "range" | "hand_over", ... } of a state of that many
/// components; which of them can be depends on what is measured.
Start read_start(TableReader& tracker, const MeasurementChoice& measurement, int states);

/// x, variance, time_s of a state of that many components; does not finish the table.
PriorStart read_prior_start(TableReader& start, int states);

/// gate_probability, lost_after_s, output_pull, ahead_s.
FilterTrackerOptions read_options(TableReader& tracker, const MeasurementChoice& measurement);

/// transition = { matrix = [...], period_s } row by row, or { leave_first, leave_other, to_first, period_s }; initial.
MarkovChain read_chain(TableReader& tracker, int modes);

}  // namespace truebearing
