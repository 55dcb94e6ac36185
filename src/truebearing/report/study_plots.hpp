// SPDX-License-Identifier: Apache-2.0
// The plots of a comparison: errors and NEES against time, figures at given times, the runs' errors as shares and pair
// by pair, and the runs that were drawn. Only what the results have: no plot is empty.
#pragma once

#include <vector>

#include "truebearing/report/plot.hpp"
#include "truebearing/report/results.hpp"

namespace truebearing {

/// Of all runs, or of a set of them; `id` begins the plots' names. What there are figures of at given times stands in
/// metric_plots() instead.
std::vector<Plot> time_plots(const ResultFigures& figures, const std::string& id);
/// Of each run's RMSE, where the results have them and runs are several.
std::vector<Plot> run_plots(const ResultFigures& figures, const std::string& id);
/// Of the figures at the times of the scoring, those of the first importance first.
std::vector<Plot> metric_plots(const ResultFigures& figures, const std::string& id);
/// Each picture as one plot; looks: of the study's trackers.
std::vector<Plot> picture_plots(const Results& results, const std::string& id);

/// All of them in the order of the page.
std::vector<Plot> study_plots(const Results& results, const std::string& id);

/// The look of a tracker by its place in the study; "bound" of what is only a bound.
Look look_of(const ResultFigures& figures, const std::string& name);
/// "Position" of "position_m"; "position (m)".
std::string capital_name(const std::string& quantity);
std::string axis_name(const std::string& quantity);

}  // namespace truebearing
