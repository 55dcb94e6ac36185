// SPDX-License-Identifier: Apache-2.0
#include "app/report_output.hpp"

#include <filesystem>
#include <system_error>

#include "app/output.hpp"
#include "truebearing/core/error.hpp"

namespace truebearing {

void add_report_arguments(const Subcommand& command, ReportArguments& arguments) {
  command.argument(
      "--report", arguments.page,
      "write the results as a page with plots, which opens from disk; --json then has what the plots show");
  command.argument("--svg", arguments.svg, "write the plots as SVG files into this folder");
}

void check_outputs(const ReportArguments& report, std::vector<std::string> outputs,
                   const std::vector<std::filesystem::path>& inputs) {
  outputs.push_back(report.page);
  check_outputs(outputs, inputs);
  if (report.svg.empty()) return;
  std::error_code unknown;
  if (const auto kind = std::filesystem::status(report.svg, unknown); exists(kind) && !is_directory(kind))
    throw InputError(report.svg, "is a file", "a folder for the plots");
  const auto place = [&](const std::string& path) {
    return std::filesystem::weakly_canonical(std::filesystem::absolute(path, unknown), unknown);
  };
  for (const std::string& output : outputs)
    if (!output.empty() && output != "-" && place(output) == place(report.svg))
      throw InputError(report.svg, "is to be a file and the folder of the plots", "a folder for the plots");
}

void write_plots(const std::string& folder, const std::vector<PlotFile>& plots) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw InputError(folder, "cannot be made: " + error.message(), "a folder");
  for (const PlotFile& plot : plots) write_output((std::filesystem::path(folder) / plot.name).string(), plot.svg);
}

void write_report(const ReportArguments& arguments, const std::vector<Results>& results) {
  if (!arguments.page.empty()) write_output(arguments.page, report_page(results));
  if (!arguments.svg.empty()) write_plots(arguments.svg, plot_files(results));
}

}  // namespace truebearing
