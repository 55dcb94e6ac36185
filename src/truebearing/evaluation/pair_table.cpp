// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/pair_table.hpp"

#include <fmt/format.h>
#include <vector>

#include "truebearing/evaluation/text_table.hpp"

namespace truebearing {

std::string pair_table(const std::string& heading, const Comparison& comparison, MetricTable table,
                       const TableLayout& layout) {
  Rows rows{{heading, "", "mean", "+-", "in standard errors"}};
  for (const Comparison::Pair& pair : comparison.pairs)
    for (const PairedDifference& difference : pair.differences)
      if (difference.table == table && !difference.time_s)
        rows.push_back({pair.a + " - " + pair.b, difference.title, fine_figure(difference.mean),
                        fine_figure(difference.se),
                        difference.se > 0.0 ? fmt::format("{:+.1f}", difference.mean / difference.se) : "-"});
  return rows.size() > 1 ? fmt::format("\n{}", aligned(rows, layout)) : std::string();
}

}  // namespace truebearing
