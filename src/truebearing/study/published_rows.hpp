// SPDX-License-Identifier: Apache-2.0
// The rows of a study's [[published]]: name, source, and figures by their names. A figure is a number, or a table with
// one for each of the study's sets:
//   [[published]]
//   name = "KalmanNet"
//   source = "Revach et al. 2022, table IX"
//   mse_db = -11.28
#pragma once

#include <string>
#include <vector>

#include "truebearing/core/state_space.hpp"
#include "truebearing/evaluation/published.hpp"
#include "truebearing/evaluation/run_score.hpp"
#include "truebearing/io/table_reader.hpp"

namespace truebearing {

/// Figures are those that a comparison by that rule has of a tracker that estimates all of `truth`. Throws InputError.
std::vector<PublishedRow> read_published(TableReader& study, const ScoringRule& rule, const StateSpace& truth,
                                         const std::vector<std::string>& sets);

}  // namespace truebearing
