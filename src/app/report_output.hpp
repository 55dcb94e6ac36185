// SPDX-License-Identifier: Apache-2.0
// --report and --svg, which several subcommands take: results as a page, its plots as files.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/arguments.hpp"
#include "truebearing/report/page.hpp"
#include "truebearing/report/results.hpp"

namespace truebearing {

struct ReportArguments {
  std::string page;  ///< a file, or empty
  std::string svg;   ///< a folder, or empty

  bool wanted() const { return !page.empty() || !svg.empty(); }
};

void add_report_arguments(const Subcommand& command, ReportArguments& arguments);

/// check_outputs() (output.hpp) of these outputs and the page; refuses too a folder for plots that is a file, or is to be
/// one of them. Throws InputError.
void check_outputs(const ReportArguments& report, std::vector<std::string> outputs,
                   const std::vector<std::filesystem::path>& inputs);

/// Writes plots into a folder, which is made where it is not there. Throws InputError.
void write_plots(const std::string& folder, const std::vector<PlotFile>& plots);

/// Writes what is wanted. Throws InputError.
void write_report(const ReportArguments& arguments, const std::vector<Results>& results);

}  // namespace truebearing
