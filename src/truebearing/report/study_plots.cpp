// SPDX-License-Identifier: Apache-2.0
#include "truebearing/report/study_plots.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <utility>

#include "truebearing/evaluation/metric.hpp"
#include "truebearing/report/axis.hpp"
#include "truebearing/report/correction_plots.hpp"
#include "truebearing/report/log_page.hpp"
#include "truebearing/report/markup.hpp"
#include "truebearing/report/plot_clock.hpp"

namespace truebearing {
namespace {

// Of the quantities that any tracker has, in the order in which they come.
std::vector<std::string> quantity_names(const ResultFigures& figures) {
  std::vector<std::string> names;
  for (const ResultTracker& tracker : figures.trackers)
    for (const ResultQuantity& quantity : tracker.quantities)
      if (std::find(names.begin(), names.end(), quantity.name) == names.end()) names.push_back(quantity.name);
  return names;
}

std::vector<const ResultTracker*> all_of(const ResultFigures& figures) {
  std::vector<const ResultTracker*> all;
  for (const ResultTracker& tracker : figures.trackers) all.push_back(&tracker);
  for (const ResultTracker& bound : figures.bounds) all.push_back(&bound);
  return all;
}

bool has_timed(const ResultFigures& figures, const std::string& metric_name) {
  return std::any_of(figures.trackers.begin(), figures.trackers.end(), [&](const ResultTracker& tracker) {
    return std::any_of(tracker.metrics.begin(), tracker.metrics.end(),
                       [&](const ResultMetric& metric) { return metric.time_s && metric.name == metric_name; });
  });
}

bool any_finite(const std::vector<double>& values) {
  return std::any_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
}

// Only the steps that are scored: what comes before would leave a gap at the edge.
void keep_finite(std::vector<double>& x, std::vector<double>& y) {
  std::size_t first = 0, last = std::min(x.size(), y.size());
  while (first < last && !std::isfinite(y[first])) ++first;
  while (last > first && !std::isfinite(y[last - 1])) --last;
  const auto cut = [&](std::vector<double>& values) {
    values = std::vector<double>(values.begin() + static_cast<std::ptrdiff_t>(first),
                                 values.begin() + static_cast<std::ptrdiff_t>(last));
  };
  cut(x);
  cut(y);
}

// A band of two standard errors, as wide as 95 % of them.
PlotSeries band_about(const Look& look, const std::vector<double>& x, const std::vector<double>& y,
                      const std::vector<double>& se) {
  PlotSeries band{"", look, Shape::band, x, y, y};
  for (std::size_t i = 0; i < y.size(); ++i) {
    const double half = i < se.size() ? 2.0 * se[i] : std::nan("");
    band.y[i] = y[i] - half;
    band.y2[i] = y[i] + half;
  }
  return band;
}

// Both logarithmic or neither, by what lines and dots hold.
void choose_y_axis(Plot& plot) {
  std::vector<double> values;
  for (const PlotSeries& series : plot.series)
    if (series.shape != Shape::band) values.insert(values.end(), series.y.begin(), series.y.end());
  plot.y_logarithmic = wants_logarithm(values);
}

// The last finite values, smallest first: what the lines end at.
std::string ends_of(const Plot& plot) {
  std::vector<std::pair<double, std::string>> ends;
  for (const PlotSeries& series : plot.series) {
    if (series.shape != Shape::line || series.name.empty()) continue;
    for (auto value = series.y.rbegin(); value != series.y.rend(); ++value)
      if (std::isfinite(*value)) {
        ends.emplace_back(*value, series.name);
        break;
      }
  }
  std::stable_sort(ends.begin(), ends.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::string text;
  for (const auto& [value, name] : ends)
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name, shown(value, 3));
  return text.empty() ? "" : fmt::format("At the end: {}.", text);
}

Plot error_plot(const ResultFigures& figures, const std::string& quantity, const std::string& id) {
  Plot plot;
  plot.id = fmt::format("{}error_{}", id, quantity);
  plot.title = fmt::format("{} error against time", capital_name(quantity));
  plot.y_label = fmt::format("RMSE of the {}", axis_name(quantity));
  const PlotClock clock(figures.trackers.front().time_s);
  plot.x_label = clock.label;
  std::vector<PlotSeries> lines;
  bool banded = false;
  for (const ResultTracker* tracker : all_of(figures)) {
    const ResultQuantity* of = tracker->quantity(quantity);
    if (!of || !any_finite(of->series)) continue;
    const Look look = look_of(figures, tracker->name);
    std::vector<double> x = clock.from(tracker->time_s), y = of->series;
    if (any_finite(of->series_se)) {
      plot.series.push_back(band_about(look, x, y, of->series_se));
      banded = true;
    }
    keep_finite(x, y);
    lines.push_back({tracker->is_bound ? tracker->name + " (bound)" : tracker->name, look, Shape::line, x, y});
  }
  plot.series.insert(plot.series.end(), lines.begin(), lines.end());
  choose_y_axis(plot);
  plot.caption = fmt::format("Root of the mean squared error over runs at each step{}.",
                             banded ? "; bands are two standard errors" : "");
  plot.summary = ends_of(plot);
  return plot;
}

// Trackers of states of the same dimension share an expected NEES.
Plot nees_plot(const ResultFigures& figures, double expected, const std::string& id) {
  Plot plot;
  plot.id = fmt::format("{}nees_{:.0f}", id, expected);
  plot.title = "Does each tracker know its error? NEES against time";
  plot.y_label = fmt::format("mean NEES, {:.0f} expected", expected);
  std::vector<PlotSeries> lines;
  for (const ResultTracker& tracker : figures.trackers) {
    if (tracker.nees_expected != expected || !any_finite(tracker.nees_of)) continue;
    const PlotClock clock(tracker.time_s);
    plot.x_label = clock.label;
    std::vector<double> x = clock.from(tracker.time_s), y = tracker.nees_of;
    if (plot.series.empty())
      plot.series.push_back(
          {"95 % of consistent trackers", {"measured"}, Shape::band, x, tracker.nees_low, tracker.nees_high});
    keep_finite(x, y);
    lines.push_back({tracker.name, look_of(figures, tracker.name), Shape::line, x, y});
  }
  plot.series.insert(plot.series.end(), lines.begin(), lines.end());
  choose_y_axis(plot);
  plot.caption =
      "Mean over runs of the squared error in units of the tracker's own covariance. Above the band a tracker claims to "
      "know more than it does, below it less.";
  plot.summary = ends_of(plot);
  return plot;
}

PlotSeries share_below(std::vector<double> errors, const std::string& name, const Look& look) {
  std::erase_if(errors, [](double error) { return !std::isfinite(error); });
  std::sort(errors.begin(), errors.end());
  PlotSeries line{name, look, Shape::line, {errors.front()}, {0.0}};
  // A plot is some 500 pixels high: of more runs every n-th is drawn, and the last.
  constexpr std::size_t kMostPoints = 500;
  const std::size_t every = errors.size() / (kMostPoints + 1) + 1, n = errors.size();
  for (std::size_t i = 0; i < n; ++i) {
    if ((n - 1 - i) % every != 0) continue;
    line.x.push_back(errors[i]);
    line.y.push_back(100.0 * static_cast<double>(i + 1) / static_cast<double>(n));
  }
  return line;
}

Plot share_plot(const ResultFigures& figures, const std::string& quantity, const std::string& id) {
  Plot plot;
  plot.id = fmt::format("{}share_{}", id, quantity);
  plot.title = fmt::format("Share of runs below each {} error", name_of(quantity));
  plot.x_label = fmt::format("RMSE of a run, {}", axis_name(quantity));
  plot.y_label = "share of runs (%)";
  std::vector<double> errors;
  std::string halves;
  for (const ResultTracker& tracker : figures.trackers) {
    const ResultQuantity* of = tracker.quantity(quantity);
    if (!of || !any_finite(of->run_rmse)) continue;
    const std::string name = tracker.is_bound ? tracker.name + " (bound)" : tracker.name;
    plot.series.push_back(share_below(of->run_rmse, name, look_of(figures, tracker.name)));
    const PlotSeries& line = plot.series.back();
    errors.insert(errors.end(), line.x.begin(), line.x.end());
    halves += fmt::format("{}{} {}", halves.empty() ? "" : ", ", name, shown(line.x[(line.x.size() - 1) / 2], 3));
  }
  plot.x_logarithmic = wants_logarithm(errors);
  plot.caption = "Lines further left are better.";
  plot.summary = fmt::format("Half of the runs are below: {}.", halves);
  return plot;
}

Plot scatter_plot(const ResultFigures& figures, const ResultPair& pair, const std::string& id, std::size_t number) {
  Plot plot;
  const ResultTracker* a = figures.tracker(pair.a);
  const ResultTracker* b = figures.tracker(pair.b);
  const ResultQuantity* of_a = a ? a->quantity(pair.quantity) : nullptr;
  const ResultQuantity* of_b = b ? b->quantity(pair.quantity) : nullptr;
  if (!of_a || !of_b) return plot;
  plot.id = fmt::format("{}pair_{}_{}", id, number, pair.quantity);
  plot.title = fmt::format("{} against {}, run by run: {}", pair.a, pair.b, name_of(pair.quantity));
  plot.x_label = fmt::format("{}: RMSE of a run, {}", pair.b, axis_name(pair.quantity));
  plot.y_label = fmt::format("{} ({})", pair.a, unit_of(pair.quantity));
  plot.equal = true;
  PlotSeries dots{"a run", look_of(figures, pair.a), Shape::dots, {}, {}};
  // Dots beyond some thousands cover each other.
  constexpr std::size_t kMostDots = 2000;
  const std::size_t runs = std::min(of_a->run_rmse.size(), of_b->run_rmse.size()), every = runs / (kMostDots + 1) + 1;
  std::size_t better = 0, compared = 0;
  for (std::size_t run = 0; run < runs; ++run) {
    if (!std::isfinite(of_a->run_rmse[run]) || !std::isfinite(of_b->run_rmse[run])) continue;
    ++compared;
    if (of_a->run_rmse[run] < of_b->run_rmse[run]) ++better;
    if (run % every != 0) continue;
    dots.x.push_back(of_b->run_rmse[run]);
    dots.y.push_back(of_a->run_rmse[run]);
  }
  if (dots.x.empty()) return plot;
  std::vector<double> both = dots.x;
  both.insert(both.end(), dots.y.begin(), dots.y.end());
  plot.x_logarithmic = plot.y_logarithmic = wants_logarithm(both);
  const auto [least, greatest] = std::minmax_element(both.begin(), both.end());
  plot.series.push_back({"the same error", {"ideal"}, Shape::line, {*least, *greatest}, {*least, *greatest}});
  plot.series.push_back(std::move(dots));
  plot.caption = fmt::format("Below the line {} is better: in {} of {} runs ({} %).", pair.a, better, compared,
                             shown(100.0 * static_cast<double>(better) / static_cast<double>(compared), 3));
  return plot;
}

void add_unless_empty(std::vector<Plot>& plots, Plot plot) {
  if (!plot.empty()) plots.push_back(std::move(plot));
}

}  // namespace

Look look_of(const ResultFigures& figures, const std::string& name) {
  for (std::size_t i = 0; i < figures.trackers.size(); ++i)
    if (figures.trackers[i].name == name) return figures.trackers[i].is_bound ? Look{"bound"} : tracker_look(i);
  return {"bound"};
}

std::string capital_name(const std::string& quantity) {
  std::string name = capitalised(name_of(quantity));
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

std::string axis_name(const std::string& quantity) {
  return fmt::format("{} ({})", name_of(quantity), unit_of(quantity));
}

std::vector<Plot> time_plots(const ResultFigures& figures, const std::string& id) {
  std::vector<Plot> plots;
  if (figures.trackers.front().time_s.size() < 2) return plots;
  for (const std::string& quantity : quantity_names(figures))
    if (!has_timed(figures, name_of(quantity) + "_rmse")) add_unless_empty(plots, error_plot(figures, quantity, id));
  if (has_timed(figures, "nees")) return plots;
  std::vector<double> dimensions;
  for (const ResultTracker& tracker : figures.trackers)
    if (std::find(dimensions.begin(), dimensions.end(), tracker.nees_expected) == dimensions.end())
      dimensions.push_back(tracker.nees_expected);
  for (const double expected : dimensions) add_unless_empty(plots, nees_plot(figures, expected, id));
  return plots;
}

std::vector<Plot> run_plots(const ResultFigures& figures, const std::string& id) {
  std::vector<Plot> plots;
  const bool has_several =
      std::any_of(figures.trackers.begin(), figures.trackers.end(), [](const ResultTracker& tracker) {
        return !tracker.quantities.empty() && tracker.quantities.front().run_rmse.size() > 1;
      });
  if (!has_several) return plots;
  for (const std::string& quantity : quantity_names(figures))
    add_unless_empty(plots, share_plot(figures, quantity, id));
  for (std::size_t i = 0; i < figures.pairs.size(); ++i)
    add_unless_empty(plots, scatter_plot(figures, figures.pairs[i], id, i));
  return plots;
}

std::vector<Plot> study_plots(const Results& results, const std::string& id) {
  std::vector<Plot> plots;
  const auto add = [&](std::vector<Plot> more) {
    for (Plot& plot : more) plots.push_back(std::move(plot));
  };
  add(time_plots(results.all, id));
  add(metric_plots(results.all, id));
  add(run_plots(results.all, id));
  add(picture_plots(results, id));
  if (results.on_log) add(log_plots(*results.on_log, id));
  add(correction_plots(results.all, id));
  return plots;
}

}  // namespace truebearing
