// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/text_table.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace truebearing {

std::string figure(double value) {
  if (!std::isfinite(value)) return "-";
  const double size = std::abs(value);
  return size >= 1e7      ? fmt::format("{:.1e}", value)
         : size >= 1000.0 ? fmt::format("{:.0f}", value)
         : size >= 100.0  ? fmt::format("{:.1f}", value)
         : size >= 10.0   ? fmt::format("{:.2f}", value)
                          : fmt::format("{:.3f}", value);
}

std::string aligned(const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::size_t> widths;
  for (const auto& row : rows)
    for (std::size_t column = 0; column < row.size(); ++column) {
      if (widths.size() <= column) widths.push_back(0);
      widths[column] = std::max(widths[column], row[column].size());
    }
  std::string text;
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t column = 0; column < row.size(); ++column)
      line += column == 0 ? fmt::format("{:<{}}", row[column], widths[column])
                          : fmt::format("  {:>{}}", row[column], widths[column]);
    text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
  }
  return text;
}

}  // namespace truebearing
