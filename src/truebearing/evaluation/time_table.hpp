// SPDX-License-Identifier: Apache-2.0
// The part of a comparison's table that has figures at given times.
#pragma once

#include <string>

#include "truebearing/evaluation/comparison.hpp"
#include "truebearing/evaluation/text_table.hpp"

namespace truebearing {

/// A block for each figure: trackers and the Cramer-Rao bound by time; then paired differences at these times, and
/// figures that belong to no time. Empty where the comparison has none of them.
std::string time_tables(const Comparison& comparison, const TableLayout& layout = {});

}  // namespace truebearing
