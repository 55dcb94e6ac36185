// SPDX-License-Identifier: Apache-2.0
// What pairs of trackers differ by, as a table.
#pragma once

#include <string>

#include "truebearing/evaluation/comparison.hpp"
#include "truebearing/evaluation/text_table.hpp"

namespace truebearing {

/// A row per difference that belongs to `table` and has no time, under that heading, with an empty line before it;
/// empty where there is none.
std::string pair_table(const std::string& heading, const Comparison& comparison, MetricTable table,
                       const TableLayout& layout = {});

}  // namespace truebearing
