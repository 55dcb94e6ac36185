// SPDX-License-Identifier: Apache-2.0
// The page of a target-motion analysis, from the JSON that `tma --json` writes: the verdict, the solution with its
// uncertainty, the geometry in the plane and the residuals.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "truebearing/report/page.hpp"
#include "truebearing/report/plot.hpp"

namespace truebearing {

/// Plots: the plane, and the residuals. Throws InputError where the JSON is none of a TMA's with its bearings; file: what
/// messages call it.
std::vector<Plot> tma_plots(std::string_view json, const std::string& file);
std::string tma_page(std::string_view json, const std::string& file);
std::vector<PlotFile> tma_plot_files(std::string_view json, const std::string& file);

}  // namespace truebearing
