// SPDX-License-Identifier: Apache-2.0
// A comparison, to read: as a table for people and as JSON for programs.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "truebearing/evaluation/comparison.hpp"
#include "truebearing/evaluation/run_picture.hpp"
#include "truebearing/evaluation/text_table.hpp"

namespace truebearing {

/// The tables that the command line prints. Of what is no bound the least RMSE is marked.
std::string comparison_table(const Comparison& comparison, const TableLayout& layout = {});

/// The results as JSON, indented, with a newline at the end. Byte for byte the same for the same comparison, timings
/// aside. With the details of the comparison, where it has them, and the pictures of its runs: what a report draws; and what
/// a log says without its truth as `on_log`, where that is given.
std::string comparison_json(const Comparison& comparison, const std::vector<RunPicture>& pictures = {},
                            const nlohmann::ordered_json* on_log = nullptr);

}  // namespace truebearing
