// SPDX-License-Identifier: Apache-2.0
// The figures of several targets as a table: swaps, losses, squared errors of clean runs, GOSPA.
#pragma once

#include <string>

#include "truebearing/evaluation/comparison.hpp"
#include "truebearing/evaluation/text_table.hpp"

namespace truebearing {

/// A row per tracker, a row per bound of the angles, and a row per difference of clean runs of the pairs, each block
/// with an empty line before it; empty where the comparison has no such figures.
std::string track_tables(const Comparison& comparison, const TableLayout& layout = {});

}  // namespace truebearing
