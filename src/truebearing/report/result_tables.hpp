// SPDX-License-Identifier: Apache-2.0
// The figures of a comparison as HTML tables.
#pragma once

#include <string>
#include <vector>

#include "truebearing/report/results.hpp"

namespace truebearing {

/// A row for each tracker and bound: RMSE with standard errors, NEES, coverage, ...; the best marked.
std::string tracker_table(const ResultFigures& figures);
/// Paired differences of the runs' RMSE, or of what else was compared; empty where there are none.
std::string paired_table(const ResultFigures& figures, bool of_rmse);
/// The figures that have no time and stand in no plot.
std::string metric_table(const ResultFigures& figures);
/// What others printed of the same problem, and where; empty where nothing was.
std::string published_table(const ResultFigures& figures);
/// RMSE of each tracker in each file, and what changed from the first; changes beyond two standard errors marked.
std::string side_by_side_table(const std::vector<Results>& all);

}  // namespace truebearing
