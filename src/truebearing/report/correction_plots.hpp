// SPDX-License-Identifier: Apache-2.0
// What corrections did, as plots: who held them back against time, how long they were, which rules fired, and the
// membership curves of each feature over the values that it had.
#pragma once

#include <vector>

#include "truebearing/report/plot.hpp"
#include "truebearing/report/results.hpp"

namespace truebearing {

/// Who held back the i-th tracker of the figures, and how long its corrections were; empty where the steps do not tell.
std::vector<Plot> correction_time_plots(const ResultFigures& figures, std::size_t i, const std::string& id);
/// How often its rules fired, then and in training; empty where it has none.
std::vector<Plot> rule_plots(const ResultFigures& figures, std::size_t i, const std::string& id);
/// A plot for each feature: the values that it had, the box of the gate, and the terms of the rules.
std::vector<Plot> feature_plots(const ResultFigures& figures, std::size_t i, const std::string& id);
/// All of them, of every correction of the figures.
std::vector<Plot> correction_plots(const ResultFigures& figures, const std::string& id);

}  // namespace truebearing
