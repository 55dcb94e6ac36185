// SPDX-License-Identifier: Apache-2.0
// The figures at the times of the scoring, one plot for each that any tracker has.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <iterator>

#include "truebearing/report/axis.hpp"
#include "truebearing/report/markup.hpp"
#include "truebearing/report/study_plots.hpp"

namespace truebearing {
namespace {

// What a reader looks for first; others follow in the order of the results.
constexpr const char* kFirst[] = {
    "range_error_rmse", "position_rmse", "course_error_rmse", "speed_error_rmse", "velocity_rmse",
    "frequency_rmse",   "nees",          "coverage95"};

std::vector<std::string> timed_names(const ResultFigures& figures) {
  std::vector<std::string> names(std::begin(kFirst), std::end(kFirst)), found;
  for (const ResultTracker& tracker : figures.trackers)
    for (const ResultMetric& metric : tracker.metrics)
      if (metric.time_s && std::find(names.begin(), names.end(), metric.name) == names.end())
        names.push_back(metric.name);
  return names;
}

std::string in_words(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  for (const auto& [from, to] :
       {std::pair{" rmse", " RMSE"}, {"nees", "NEES"}, {"coverage95", "share inside the 95 % ellipse"}})
    if (const std::size_t place = name.find(from); place != std::string::npos)
      name.replace(place, std::string_view(from).size(), to);
  return name;
}

PlotSeries line_of(const ResultTracker& tracker, const std::string& metric_name, const Look& look, PlotSeries& band,
                   std::string& unit) {
  PlotSeries line{tracker.is_bound ? tracker.name + " (bound)" : tracker.name, look, Shape::line, {}, {}};
  band = {"", look, Shape::band, {}, {}, {}};
  for (const ResultMetric& metric : tracker.metrics) {
    if (metric.name != metric_name || !metric.time_s) continue;
    line.x.push_back(*metric.time_s);
    line.y.push_back(metric.value);
    band.x.push_back(*metric.time_s);
    const bool share = metric.unit == "share";
    band.y.push_back(share ? std::max(0.0, metric.value - 2.0 * metric.se) : metric.value - 2.0 * metric.se);
    band.y2.push_back(share ? std::min(1.0, metric.value + 2.0 * metric.se) : metric.value + 2.0 * metric.se);
    unit = metric.unit;
  }
  return line;
}

// Times that are set ever wider apart.
bool are_spread(const std::vector<double>& times_s) {
  double least = kInfinity, most = 0.0;
  for (std::size_t i = 1; i < times_s.size(); ++i) {
    least = std::min(least, times_s[i] - times_s[i - 1]);
    most = std::max(most, times_s[i] - times_s[i - 1]);
  }
  constexpr double kTenfold = 10.0;
  return !times_s.empty() && times_s.front() > 0.0 && most > kTenfold * least;
}

Plot metric_plot(const ResultFigures& figures, const std::string& name, const std::string& id) {
  Plot plot;
  plot.id = fmt::format("{}at_times_{}", id, name);
  plot.title = capitalised(in_words(name)) + " at the scored times";
  plot.x_label = "time (s)";
  std::vector<PlotSeries> lines;
  std::vector<double> values;
  std::string unit;
  const auto add = [&](const ResultTracker& tracker) {
    PlotSeries band;
    PlotSeries line = line_of(tracker, name, look_of(figures, tracker.name), band, unit);
    if (line.x.size() < 2) return;
    values.insert(values.end(), line.y.begin(), line.y.end());
    plot.series.push_back(std::move(band));
    lines.push_back(std::move(line));
  };
  for (const ResultTracker& tracker : figures.trackers) add(tracker);
  if (lines.empty()) return plot;
  plot.x_logarithmic = are_spread(lines.front().x);
  for (const ResultTracker& bound : figures.bounds) add(bound);
  plot.series.insert(plot.series.end(), lines.begin(), lines.end());
  plot.y_logarithmic = wants_logarithm(values);
  plot.y_label =
      unit.empty() || unit == "1" || unit == "share" ? in_words(name) : fmt::format("{} ({})", in_words(name), unit);
  plot.caption = "Bands are two standard errors over runs.";
  return plot;
}

}  // namespace

std::vector<Plot> metric_plots(const ResultFigures& figures, const std::string& id) {
  std::vector<Plot> plots;
  for (const std::string& name : timed_names(figures))
    if (Plot plot = metric_plot(figures, name, id); !plot.empty()) plots.push_back(std::move(plot));
  return plots;
}

}  // namespace truebearing
