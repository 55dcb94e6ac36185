// SPDX-License-Identifier: Apache-2.0
// The composed tracker of a passive sonar from its table in a study:
//     hand_over_s, hand_over_percent, false_alarm_probability, manoeuvre_mps, steady_probability, show_batch
//     measurement, space             of both parts, where they do not say otherwise
//     batch = { ... }                a tracker of kind "bearings_batch"
//     filter = { kind = ..., ... }   kalman, unscented, modified_gain or imm, which begins where the batch ends
#pragma once

#include <memory>

#include "truebearing/io/table_reader.hpp"
#include "truebearing/tracker/successor.hpp"
#include "truebearing/tracker/tracker.hpp"

namespace truebearing {

std::unique_ptr<Tracker> make_passive_sonar_tracker(TableReader& table);
/// The same with a filter that is made already; the table has no `filter`.
std::unique_ptr<Tracker> make_passive_sonar_with(TableReader& table, std::unique_ptr<Successor> filter);

}  // namespace truebearing
