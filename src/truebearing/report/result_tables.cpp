// SPDX-License-Identifier: Apache-2.0
#include "truebearing/report/result_tables.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "truebearing/evaluation/metric.hpp"
#include "truebearing/report/markup.hpp"
#include "truebearing/report/study_plots.hpp"
#include "truebearing/report/verdict.hpp"

namespace truebearing {
namespace {

std::string head_cell(const std::string& markup) {
  return fmt::format("<th scope=\"col\">{}</th>", markup);
}

std::string cell(double value, int digits = 4) {
  return fmt::format("<td>{}</td>", shown(value, digits));
}

std::string with_se(double value, double se) {
  return std::isfinite(se) ? fmt::format("{} <span class=\"se\">± {}</span>", shown(value), shown(se, 2))
                           : shown(value);
}

std::string table(const std::string& head, const std::string& rows) {
  return fmt::format(
      "<div class=\"wide\" tabindex=\"0\"><table><thead><tr>{}</tr></thead><tbody>\n{}</tbody></table></div>\n", head,
      rows);
}

// Does any tracker have it?
template <typename Value>
bool any_has(const ResultFigures& figures, const Value& value) {
  return std::any_of(figures.trackers.begin(), figures.trackers.end(),
                     [&](const ResultTracker& tracker) { return std::isfinite(value(tracker)); });
}

const std::vector<ResultQuantity>& columns_of(const ResultFigures& figures) {
  return std::max_element(figures.trackers.begin(), figures.trackers.end(),
                          [](const auto& a, const auto& b) { return a.quantities.size() < b.quantities.size(); })
      ->quantities;
}

struct FigureColumn {
  const char* heading;
  double ResultTracker::*value;
  int digits;
};

constexpr FigureColumn kFigureColumns[] = {{"inside 95 %", &ResultTracker::coverage95, 3},
                                           {"lost runs", &ResultTracker::loss_rate, 3},
                                           {"gate", &ResultTracker::mean_gate, 3},
                                           {"ns per step", &ResultTracker::ns_per_step, 3}};

// From "tuned", as studies call their honest baseline, to a tracker that is a bound: how far do corrections come?
struct Way {
  const ResultTracker* from;
  const ResultTracker* to;
};

Way way_of(const ResultFigures& figures) {
  const ResultTracker* to = nullptr;
  for (const ResultTracker& tracker : figures.trackers)
    if (tracker.is_bound && !to) to = &tracker;
  return {figures.tracker("tuned"), to};
}

double share_of_way(const Way& way, const ResultTracker& tracker, const std::string& quantity) {
  if (!way.from || !way.to) return kNaN;
  const ResultQuantity* of = tracker.quantity(quantity);
  const ResultQuantity* from = way.from->quantity(quantity);
  const ResultQuantity* to = way.to->quantity(quantity);
  return of && from && to ? share_of_the_way(of->rmse, from->rmse, to->rmse) : kNaN;
}

std::string name_cell(const ResultFigures& figures, const ResultTracker& tracker) {
  const std::string tag = tracker.is_bound ? "<span class=\"tag\">bound</span>" : "";
  return fmt::format(
      "<th scope=\"row\"><svg class=\"swatch\" viewBox=\"0 0 28 10\" aria-hidden=\"true\"><path "
      "class=\"line {}\" d=\"M2 5h24\"/></svg>{}{}</th>",
      look_of(figures, tracker.name).name, escaped(tracker.name), tag);
}

std::string tracker_row(const ResultFigures& figures, const ResultTracker& tracker, bool with_way, bool with_nees) {
  std::string row = name_cell(figures, tracker);
  const Way way = way_of(figures);
  for (const ResultQuantity& column : columns_of(figures)) {
    const ResultQuantity* quantity = tracker.quantity(column.name);
    const bool best = quantity && best_in(figures, column.name) == &tracker;
    row += best ? "<td class=\"best\">" : "<td>";
    row += quantity ? with_se(quantity->rmse, quantity->rmse_se) : "-";
    row += best ? "<span class=\"tag\">best</span></td>" : "</td>";
    if (with_way) row += cell(share_of_way(way, tracker, column.name), 3);
  }
  if (with_nees)
    row += std::isfinite(tracker.nees) ? fmt::format("<td>{} <span class=\"se\">of {:.0f}</span></td>",
                                                     shown(tracker.nees), tracker.nees_expected)
                                       : "<td>-</td>";
  for (const FigureColumn& column : kFigureColumns)
    if (any_has(figures, [&](const ResultTracker& t) { return t.*column.value; }))
      row += cell(tracker.*column.value, column.digits);
  return fmt::format("<tr>{}</tr>\n", row);
}

std::string phrase(const std::string& name) {
  std::string words = name;
  std::replace(words.begin(), words.end(), '_', ' ');
  return words;
}

}  // namespace

std::string tracker_table(const ResultFigures& figures) {
  std::string head = head_cell("tracker"), rows;
  const Way way = way_of(figures);
  const bool with_way = way.from && way.to && way.from != way.to;
  for (const ResultQuantity& column : columns_of(figures)) {
    head += head_cell(escaped(fmt::format("{} RMSE ({})", name_of(column.name), unit_of(column.name))));
    if (with_way) head += head_cell(escaped("way to " + way.to->name + " (%)"));
  }
  const bool with_nees = any_has(figures, [](const ResultTracker& t) { return t.nees; });
  if (with_nees) head += head_cell("NEES");
  for (const FigureColumn& column : kFigureColumns)
    if (any_has(figures, [&](const ResultTracker& t) { return t.*column.value; })) head += head_cell(column.heading);
  for (const ResultTracker& tracker : figures.trackers) rows += tracker_row(figures, tracker, with_way, with_nees);
  for (const ResultTracker& bound : figures.bounds)
    if (std::any_of(bound.quantities.begin(), bound.quantities.end(),
                    [](const ResultQuantity& quantity) { return std::isfinite(quantity.rmse); }))
      rows += tracker_row(figures, bound, with_way, with_nees);
  return table(head, rows);
}

std::string paired_table(const ResultFigures& figures, bool of_rmse) {
  std::string rows;
  for (const ResultPair& pair : figures.pairs) {
    const ResultTracker* tracker = figures.tracker(pair.a);
    const bool is_rmse = tracker && tracker->quantity(pair.quantity);
    if (is_rmse != of_rmse) continue;
    rows += fmt::format("<tr><th scope=\"row\">{} − {}</th><td>{}</td><td>{}</td>{}</tr>\n", escaped(pair.a),
                        escaped(pair.b), escaped(is_rmse ? axis_name(pair.quantity) : phrase(pair.quantity)),
                        with_se(pair.mean, pair.se), cell(std::abs(pair.mean / pair.se), 2));
  }
  if (rows.empty()) return {};
  return table(head_cell("paired, run by run") + head_cell(of_rmse ? "RMSE of a run" : "figure of a run") +
                   head_cell("mean difference") + head_cell("standard errors"),
               rows);
}

std::string metric_table(const ResultFigures& figures) {
  std::vector<std::pair<std::string, std::string>> names;  // with their units
  for (const ResultTracker& tracker : figures.trackers)
    for (const ResultMetric& metric : tracker.metrics) {
      const std::pair name{metric.name, metric.unit};
      if (!metric.time_s && std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
  if (names.empty()) return {};
  std::string head = head_cell("figure"), rows;
  for (const ResultTracker& tracker : figures.trackers) head += head_cell(escaped(tracker.name));
  for (const auto& [name, unit] : names) {
    rows +=
        fmt::format("<tr><th scope=\"row\">{}</th>",
                    escaped(unit.empty() || unit == "1" ? phrase(name) : fmt::format("{} ({})", phrase(name), unit)));
    for (const ResultTracker& tracker : figures.trackers) {
      const auto metric =
          std::find_if(tracker.metrics.begin(), tracker.metrics.end(),
                       [&, &name = name](const ResultMetric& m) { return m.name == name && !m.time_s; });
      rows += fmt::format("<td>{}</td>", metric == tracker.metrics.end() ? "-" : with_se(metric->value, metric->se));
    }
    rows += "</tr>\n";
  }
  return table(head, rows);
}

std::string published_table(const ResultFigures& figures) {
  if (figures.published.empty()) return {};
  std::vector<std::string> names;
  for (const ResultPublished& row : figures.published)
    for (const auto& [name, value] : row.figures)
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  // The unit of a metric stands with the trackers' own figures of it, that of an RMSE in its name.
  const auto heading = [&](const std::string& name) {
    for (const ResultTracker& tracker : figures.trackers) {
      if (tracker.quantity(name)) return fmt::format("{} RMSE ({})", name_of(name), unit_of(name));
      for (const ResultMetric& metric : tracker.metrics)
        if (metric.name == name && !metric.unit.empty() && metric.unit != "1")
          return fmt::format("{} ({})", phrase(name), metric.unit);
    }
    return phrase(name);
  };
  std::string head = head_cell("published"), rows;
  for (const std::string& name : names) head += head_cell(escaped(heading(name)));
  for (const ResultPublished& row : figures.published) {
    rows += fmt::format("<tr><th scope=\"row\">{}</th>", escaped(row.name));
    for (const std::string& name : names) {
      const auto figure =
          std::find_if(row.figures.begin(), row.figures.end(), [&](const auto& f) { return f.first == name; });
      rows += cell(figure == row.figures.end() ? kNaN : figure->second);
    }
    rows += fmt::format("<td>{}</td></tr>\n", escaped(row.source));
  }
  return table(head + head_cell("printed in"), rows) +
         "<p class=\"note\">Published: printed by others for the same problem, not run here.</p>\n";
}

std::string side_by_side_table(const std::vector<Results>& all) {
  constexpr double kMarked = 2.0, kOfHundred = 100.0;
  std::vector<std::pair<std::string, std::string>> rows_of;  // tracker and quantity
  for (const Results& results : all)
    for (const ResultTracker& tracker : results.all.trackers)
      for (const ResultQuantity& quantity : tracker.quantities)
        if (const std::pair row{tracker.name, quantity.name};
            std::find(rows_of.begin(), rows_of.end(), row) == rows_of.end())
          rows_of.push_back(row);
  const auto find = [](const Results& results, const auto& row) {
    const ResultTracker* tracker = results.all.tracker(row.first);
    return tracker ? tracker->quantity(row.second) : nullptr;
  };
  std::string head = head_cell("tracker") + head_cell("RMSE"), rows;
  for (const Results& results : all) head += head_cell(escaped(results.file));
  for (const auto& row : rows_of) {
    rows += fmt::format("<tr><th scope=\"row\">{}</th><td>{}</td>", escaped(row.first), escaped(title_of(row.second)));
    const ResultQuantity* first = find(all.front(), row);
    for (std::size_t i = 0; i < all.size(); ++i) {
      const ResultQuantity* quantity = find(all[i], row);
      rows += "<td>" + (quantity ? with_se(quantity->rmse, quantity->rmse_se) : std::string("-"));
      if (i > 0 && first && quantity && std::isfinite(quantity->rmse / first->rmse)) {
        const double change = quantity->rmse - first->rmse;
        const bool marked = std::abs(change) > kMarked * std::hypot(quantity->rmse_se, first->rmse_se);
        rows += fmt::format(" <span class=\"{}\">{}{} %</span>",
                            !marked        ? "se"
                            : change > 0.0 ? "up"
                                           : "down",
                            !marked        ? ""
                            : change > 0.0 ? "▲ "
                                           : "▼ ",
                            shown(kOfHundred * change / first->rmse, 2));
      }
      rows += "</td>";
    }
    rows += "</tr>\n";
  }
  return table(head, rows);
}

}  // namespace truebearing
