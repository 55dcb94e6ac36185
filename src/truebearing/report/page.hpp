// SPDX-License-Identifier: Apache-2.0
// The report: one page that opens from disk. Nothing in it comes from elsewhere; it is complete without its script, and
// prints as it stands.
#pragma once

#include <string>
#include <vector>

#include "truebearing/report/results.hpp"

namespace truebearing {

/// One or more results, the first of which the others are compared with. Throws nothing: what a file lacks is left out.
std::string report_page(const std::vector<Results>& all);

/// The plots of the page as SVG files: name and text.
struct PlotFile {
  std::string name;  ///< "radar_1d_family_error_position_m.svg"
  std::string svg;
};
std::vector<PlotFile> plot_files(const std::vector<Results>& all);

}  // namespace truebearing
