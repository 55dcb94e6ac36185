// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/track_table.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <vector>

#include "truebearing/evaluation/pair_table.hpp"
#include "truebearing/evaluation/text_table.hpp"

namespace truebearing {
namespace {

const Metric* find(const std::vector<Metric>& metrics, const std::string& name) {
  const auto found = std::find_if(metrics.begin(), metrics.end(), [&](const Metric& m) { return m.name == name; });
  return found == metrics.end() ? nullptr : &*found;
}

bool is_count(const Metric& metric) {
  return metric.unit == "runs";
}

// The figures of any tracker, each once; those of clean runs first, as track_metrics gives them.
std::vector<Metric> columns_of(const Comparison& comparison) {
  std::vector<Metric> columns;
  for (const TrackerSummary& summary : comparison.trackers)
    for (const Metric& metric : summary.metrics)
      if (metric.table == MetricTable::tracks && !find(columns, metric.name)) columns.push_back(metric);
  return columns;
}

std::string track_title(const Metric& metric) {
  std::string words = metric.name;
  std::replace(words.begin(), words.end(), '_', ' ');
  const bool plain = is_count(metric) || metric.unit == "share" || metric.unit == "1";
  return plain ? words : words + " " + metric.unit;
}

// Squares of small errors need a digit more.
std::string figure_of(const Metric& metric, double value) {
  const double size = std::abs(value);
  return metric.unit.ends_with("^2") && size > 0.0 && size < 0.1 ? fmt::format("{:.4f}", value) : figure(value);
}

std::string tracker_rows(const Comparison& comparison, const TableLayout& layout) {
  const std::vector<Metric> columns = columns_of(comparison);
  if (columns.empty()) return {};
  Rows rows{{"tracks"}};
  for (const Metric& column : columns) {
    rows[0].push_back(track_title(column));
    if (!is_count(column)) rows[0].push_back("+-");
  }
  for (const TrackerSummary& summary : comparison.trackers) {
    rows.push_back({summary.name});
    for (const Metric& column : columns) {
      const Metric* metric = find(summary.metrics, column.name);
      if (is_count(column)) {
        rows.back().push_back(metric ? fmt::format("{:.0f}", metric->value) : "-");
        continue;
      }
      rows.back().push_back(metric ? figure_of(*metric, metric->value) : "-");
      rows.back().push_back(metric ? figure_of(*metric, metric->se) : "-");
    }
  }
  return fmt::format("\n{}", aligned(rows, layout));
}

// What those cannot fall below.
std::string bound_rows(const Comparison& comparison, const TableLayout& layout) {
  if (comparison.angle_bounds.empty()) return {};
  std::vector<Metric> columns;
  for (const AngleBoundSummary& bound : comparison.angle_bounds)
    for (const AngleBoundSummary::Quantity& quantity : bound.quantities)
      if (!find(columns, quantity.mse.name)) columns.push_back(quantity.mse);
  Rows rows{{"bounds"}};
  for (const Metric& column : columns) rows[0].insert(rows[0].end(), {track_title(column), "+-"});
  for (const AngleBoundSummary& bound : comparison.angle_bounds) {
    rows.push_back({bound.name});
    std::vector<Metric> metrics;
    for (const AngleBoundSummary::Quantity& quantity : bound.quantities) metrics.push_back(quantity.mse);
    for (const Metric& column : columns) {
      const Metric* metric = find(metrics, column.name);
      rows.back().push_back(metric ? figure_of(*metric, metric->value) : "-");
      rows.back().push_back(metric ? figure_of(*metric, metric->se) : "-");
    }
  }
  return fmt::format("\n{}", aligned(rows, layout));
}

}  // namespace

std::string track_tables(const Comparison& comparison, const TableLayout& layout) {
  return tracker_rows(comparison, layout) + bound_rows(comparison, layout) +
         pair_table("paired, per-run MSE of runs clean with both", comparison, MetricTable::tracks, layout);
}

}  // namespace truebearing
