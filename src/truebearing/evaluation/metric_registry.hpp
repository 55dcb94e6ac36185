// SPDX-License-Identifier: Apache-2.0
// The metric families by their keys in a study's table [scoring]. Each is in a file of its own, which says what its key
// is; times_s = [280.0, ...], ascending, is of all that have figures at given times.
#pragma once

#include "truebearing/core/state_space.hpp"
#include "truebearing/evaluation/run_score.hpp"
#include "truebearing/io/table_reader.hpp"

namespace truebearing {

/// Asks for the keys above and makes the families of `rule`: those that they ask for and the usual ones. `truth` is the
/// space of the scenario's. Throws InputError.
void read_metrics(TableReader& scoring, const StateSpace& truth, ScoringRule& rule);

/// Of a family's own table: the name of a quantity of the truth that has one component.
std::string read_scalar_quantity(TableReader& table, const StateSpace& truth);

}  // namespace truebearing
