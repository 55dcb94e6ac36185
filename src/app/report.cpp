// SPDX-License-Identifier: Apache-2.0
// truebearing report RESULTS.json... -o FILE.html: results that were kept, as a page; several side by side.
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "app/output.hpp"
#include "app/report_output.hpp"
#include "app/subcommands.hpp"
#include "truebearing/io/file.hpp"
#include "truebearing/report/log_page.hpp"

namespace truebearing {
namespace {

struct PageArguments {
  std::vector<std::string> results;
  ReportArguments report;
};

void make_page(const PageArguments& options) {
  check_outputs(options.report, {}, {options.results.begin(), options.results.end()});
  if (options.results.size() == 1) {  // of a log without truth, which has nothing to be set beside
    const std::string json = read_text_file(options.results[0], std::size_t{1} << 28);
    if (is_log_results(json, options.results[0])) {
      write_output(options.report.page, log_page(json, options.results[0]));
      if (!options.report.svg.empty()) write_plots(options.report.svg, log_plot_files(json, options.results[0]));
    } else {
      write_report(options.report, {parse_results(json, options.results[0])});
    }
    return;
  }
  std::vector<Results> all;
  for (const std::string& file : options.results) all.push_back(read_results(file));
  write_report(options.report, all);
}

}  // namespace

void add_report(const Subcommands& all) {
  auto options = std::make_shared<PageArguments>();
  const Subcommand command = all.add("report", "make a page with plots of results that compare or track --json wrote");
  command.argument("results", options->results, "results (JSON); several are set side by side").required();
  command.argument("-o,--output", options->report.page, "the page to write; - is standard output").required();
  command.argument("--svg", options->report.svg, "write the plots as SVG files into this folder");
  command.runs([options] { make_page(*options); });
}

}  // namespace truebearing
