// SPDX-License-Identifier: Apache-2.0
// The page of a log without truth, from the JSON that `track --json` writes: the tracks, how large the innovations were
// for what each tracker claims, what was not used and why, and what the trackers noticed. The page of one that has a
// truth holds the same beside its errors.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "truebearing/report/log_results.hpp"
#include "truebearing/report/page.hpp"
#include "truebearing/report/plot.hpp"

namespace truebearing {

/// The tracks, played over time, where they are there; then of each tracker its innovations and their NIS. `id` begins the
/// plots' names.
std::vector<Plot> log_plots(const LogResults& results, const std::string& id = {});
/// What the page of results says of their log beside its truth; empty where they are of none.
std::string on_log_section(const Results& results, const std::string& id);
/// Throws InputError where the JSON is none of a log; file: what messages call it.
std::string log_page(std::string_view json, const std::string& file);
std::vector<PlotFile> log_plot_files(std::string_view json, const std::string& file);

/// In a sentence: who is consistent, by its NIS, and who is not.
std::string log_answer(const LogResults& results);

}  // namespace truebearing
