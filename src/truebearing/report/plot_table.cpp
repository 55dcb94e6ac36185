// SPDX-License-Identifier: Apache-2.0
// The numbers of a plot as tables: what a reader without eyes for plots, or with a question about one point, looks at.
#include <algorithm>
#include <fmt/format.h>

#include "truebearing/report/markup.hpp"
#include "truebearing/report/plot.hpp"

namespace truebearing {
namespace {

// As many as one scrolls through; the results have them all.
constexpr std::size_t kMostRows = 40;

struct Column {
  std::string heading;
  const std::vector<double>* values;
};

bool is_same(double a, double b) {
  return a == b || (a != a && b != b);
}

bool share_x(const PlotSeries& a, const PlotSeries& b) {
  return a.x.size() == b.x.size() && std::equal(a.x.begin(), a.x.end(), b.x.begin(), is_same);
}

void add_columns(const PlotSeries& series, std::vector<Column>& columns) {
  const std::string& name = series.name;
  if (series.shape == Shape::band) {
    columns.push_back({name + ", from", &series.y});
    columns.push_back({name + ", to", &series.y2});
  } else {
    columns.push_back({name, &series.y});
    if (series.shape == Shape::sights) columns.push_back({"bearing (deg)", &series.y2});
  }
}

std::string table_of(const Plot& plot, const PlotSeries& first, const std::vector<Column>& columns) {
  const std::size_t rows = first.x.size(), every = (rows + kMostRows - 1) / kMostRows;
  std::string text = fmt::format("<div class=\"wide\" tabindex=\"0\"><table><thead><tr><th scope=\"col\">{}</th>",
                                 escaped(plot.x_label));
  for (const Column& column : columns) text += fmt::format("<th scope=\"col\">{}</th>", escaped(column.heading));
  text += "</tr></thead><tbody>\n";
  for (std::size_t row = 0; row < rows; row += every) {
    text += fmt::format("<tr><td>{}</td>", shown(first.x[row], 6));
    for (const Column& column : columns)
      text += fmt::format("<td>{}</td>", row < column.values->size() ? shown((*column.values)[row]) : "-");
    text += "</tr>\n";
  }
  text += "</tbody></table></div>\n";
  if (every > 1) text += fmt::format("<p class=\"note\">One row in {} of {}.</p>\n", every, rows);
  return text;
}

bool has_numbers(const PlotSeries& series) {
  return !series.name.empty() && series.look.name != "ideal" && series.shape != Shape::ellipses &&
         series.shape != Shape::cells && !series.x.empty();
}

}  // namespace

std::string number_tables(const Plot& plot) {
  std::string text;
  std::vector<bool> done(plot.series.size());
  for (std::size_t i = 0; i < plot.series.size(); ++i) {
    if (done[i] || !has_numbers(plot.series[i])) continue;
    std::vector<Column> columns;
    for (std::size_t j = i; j < plot.series.size(); ++j) {
      if (done[j] || !has_numbers(plot.series[j]) || !share_x(plot.series[i], plot.series[j])) continue;
      add_columns(plot.series[j], columns);
      done[j] = true;
    }
    text += table_of(plot, plot.series[i], columns);
  }
  return text;
}

}  // namespace truebearing
