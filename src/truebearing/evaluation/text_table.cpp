// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/text_table.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace truebearing {
namespace {

constexpr std::size_t kGap = 2;  // between two columns

std::vector<std::size_t> widths_of(const Rows& rows) {
  std::vector<std::size_t> widths;
  for (const auto& row : rows)
    for (std::size_t column = 0; column < row.size(); ++column) {
      if (widths.size() <= column) widths.push_back(0);
      widths[column] = std::max(widths[column], row[column].size());
    }
  return widths;
}

bool belongs_to_the_one_before(const Rows& rows, std::size_t column) {
  const std::string name = column < rows[0].size() ? rows[0][column] : "";
  return column > 1 && (name == "+-" || name.starts_with("/"));
}

// Where the columns of each block begin: the first of all stands before every block.
std::vector<std::size_t> blocks_of(const Rows& rows, const std::vector<std::size_t>& widths, std::size_t width) {
  std::vector<std::size_t> begins{1};
  std::size_t used = widths[0];
  for (std::size_t column = 1; column < widths.size();) {
    std::size_t end = column + 1, group = kGap + widths[column];
    for (; end < widths.size() && belongs_to_the_one_before(rows, end); ++end) group += kGap + widths[end];
    if (width > 0 && used + group > width && column > begins.back()) {
      begins.push_back(column);
      used = widths[0];
    }
    used += group;
    column = end;
  }
  begins.push_back(std::max<std::size_t>(widths.size(), 1));
  return begins;
}

std::string block(const Rows& rows, const std::vector<std::size_t>& widths, std::size_t begin, std::size_t end) {
  std::string text;
  for (const auto& row : rows) {
    std::string line = fmt::format("{:<{}}", row.empty() ? "" : row[0], widths[0]);
    for (std::size_t column = begin; column < std::min(end, row.size()); ++column)
      line += fmt::format("  {:>{}}", row[column], widths[column]);
    text += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
  }
  return text;
}

bool is_indented(const std::vector<std::string>& row) {
  return !row.empty() && row[0].starts_with("  ");
}

std::string in_markdown(const Rows& rows) {
  const bool has_parts = std::any_of(rows.begin(), rows.end(), is_indented);
  const std::size_t columns = widths_of(rows).size();
  std::string text;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const bool is_heading = i == 0 || (has_parts && !is_indented(rows[i]));
    if (is_heading && i > 0) text += "\n";
    text += "|";
    for (std::size_t column = 0; column < columns; ++column) {
      const std::string cell = column < rows[i].size() ? rows[i][column] : "";
      const std::size_t begin = cell.find_first_not_of(' ');
      text += begin == std::string::npos ? " |" : fmt::format(" {} |", cell.substr(begin));
    }
    text += "\n";
    if (!is_heading) continue;
    text += "|---|";
    for (std::size_t column = 1; column < columns; ++column) text += "---:|";
    text += "\n";
  }
  return text;
}

}  // namespace

std::string figure(double value) {
  if (!std::isfinite(value)) return "-";
  const double size = std::abs(value);
  return size >= 1e7      ? fmt::format("{:.1e}", value)
         : size >= 1000.0 ? fmt::format("{:.0f}", value)
         : size >= 100.0  ? fmt::format("{:.1f}", value)
         : size >= 10.0   ? fmt::format("{:.2f}", value)
                          : fmt::format("{:.3f}", value);
}

std::string fine_figure(double value) {
  constexpr double kFine = 0.2, kLeast = 1e-6;
  const double size = std::abs(value);
  if (!(size < kFine) || size < kLeast) return figure(value);
  return fmt::format("{:.{}f}", value, std::min(2 - static_cast<int>(std::floor(std::log10(size))), 6));
}

std::string aligned(const Rows& rows, const TableLayout& layout) {
  if (rows.empty()) return {};
  if (layout.markdown) return in_markdown(rows);
  const std::vector<std::size_t> widths = widths_of(rows);
  if (widths.empty()) return {};
  const std::vector<std::size_t> begins = blocks_of(rows, widths, layout.width);
  std::string text;
  for (std::size_t i = 0; i + 1 < begins.size(); ++i)
    text += (i == 0 ? "" : "\n") + block(rows, widths, begins[i], begins[i + 1]);
  return text;
}

std::string marked(const std::string& figure, bool is_best, const TableLayout& layout) {
  if (layout.markdown) return is_best ? "**" + figure + "**" : figure;
  return figure + (is_best ? "*" : " ");
}

}  // namespace truebearing
