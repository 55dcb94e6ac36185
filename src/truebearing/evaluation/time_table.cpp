// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/time_table.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <utility>
#include <vector>

#include "truebearing/evaluation/text_table.hpp"

namespace truebearing {
namespace {

// Those metrics of all trackers that `belongs` picks, each name once, in the order in which they first come.
template <typename Belongs>
std::vector<Metric> kinds(const Comparison& comparison, const Belongs& belongs) {
  std::vector<Metric> found;
  for (const TrackerSummary& summary : comparison.trackers)
    for (const Metric& metric : summary.metrics) {
      const auto same = [&](const Metric& other) { return other.name == metric.name; };
      if (belongs(metric) && std::none_of(found.begin(), found.end(), same)) found.push_back(metric);
    }
  return found;
}

std::vector<double> times_of(const Comparison& comparison, const std::string& name) {
  std::vector<double> times_s;
  for (const TrackerSummary& summary : comparison.trackers)
    for (const Metric& metric : summary.metrics)
      if (metric.name == name && std::find(times_s.begin(), times_s.end(), *metric.time_s) == times_s.end())
        times_s.push_back(*metric.time_s);
  return times_s;
}

std::string value_at(const std::vector<Metric>& metrics, const std::string& name, std::optional<double> time_s) {
  for (const Metric& metric : metrics)
    if (metric.name == name && metric.time_s == time_s) return figure(metric.value);
  return "-";
}

std::string title(const Metric& kind) {
  std::string words = kind.name;
  std::replace(words.begin(), words.end(), '_', ' ');
  if (kind.unit == "dB" && words.ends_with(" db")) words.resize(words.size() - 3);  // it says its unit itself
  return kind.unit == "1" || kind.unit == "share" ? words : words + " " + kind.unit;
}

void add_block(const Comparison& comparison, const Metric& kind, Rows& rows) {
  const std::vector<double> times_s = times_of(comparison, kind.name);
  rows.push_back({title(kind)});
  for (const double time_s : times_s) rows.back().push_back(fmt::format("{:g} s", time_s));
  const auto add_row = [&](const std::string& name, const std::vector<Metric>& metrics) {
    if (std::none_of(metrics.begin(), metrics.end(), [&](const Metric& metric) { return metric.name == kind.name; }))
      return;
    rows.push_back({"  " + name});
    for (const double time_s : times_s) rows.back().push_back(value_at(metrics, kind.name, time_s));
  };
  for (const TrackerSummary& summary : comparison.trackers) add_row(summary.name, summary.metrics);
  if (comparison.cramer_rao) add_row("cramer_rao", comparison.cramer_rao->metrics);
}

// "a - b, position" by time: the mean difference, and how many of its standard errors that is.
void add_pairs(const Comparison& comparison, Rows& rows) {
  for (const Comparison::Pair& pair : comparison.pairs) {
    std::string title;
    for (const PairedDifference& difference : pair.differences) {
      if (!difference.time_s) continue;
      if (title != difference.title) {
        title = difference.title;
        rows.push_back({fmt::format("  {} - {}, {}", pair.a, pair.b, title)});
      }
      rows.back().push_back(difference.se > 0.0
                                ? fmt::format("{} ({:+.1f})", figure(difference.mean), difference.mean / difference.se)
                                : figure(difference.mean));
    }
  }
}

const Metric* find_timeless(const TrackerSummary& summary, const std::string& name) {
  for (const Metric& metric : summary.metrics)
    if (metric.name == name && !metric.time_s) return &metric;
  return nullptr;
}

// Figures at no time, with the standard errors of those that have one, and what was published of them.
Rows timeless_rows(const Comparison& comparison, const std::vector<Metric>& kinds) {
  if (kinds.empty()) return {};
  Rows rows{{"tracker"}};
  std::vector<bool> has_se;
  for (const Metric& kind : kinds) {
    has_se.push_back(std::any_of(comparison.trackers.begin(), comparison.trackers.end(), [&](const auto& summary) {
      const Metric* metric = find_timeless(summary, kind.name);
      return metric && std::isfinite(metric->se);
    }));
    rows[0].push_back(title(kind));
    if (has_se.back()) rows[0].emplace_back("+-");
  }
  for (const TrackerSummary& summary : comparison.trackers) {
    rows.push_back({summary.name});
    for (std::size_t i = 0; i < kinds.size(); ++i) {
      const Metric* metric = find_timeless(summary, kinds[i].name);
      rows.back().push_back(metric ? figure(metric->value) : "-");
      if (has_se[i]) rows.back().push_back(metric ? figure(metric->se) : "-");
    }
  }
  for (const PublishedRow& published : comparison.published) {
    bool has_any = false;
    std::vector<std::string> row{published_title(published)};
    for (std::size_t i = 0; i < kinds.size(); ++i) {
      const std::optional<double> value = published.figure(kinds[i].name);
      has_any |= value.has_value();
      row.push_back(value ? figure(*value) : "-");
      if (has_se[i]) row.emplace_back("-");
    }
    if (has_any) rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace

std::string time_tables(const Comparison& comparison, const TableLayout& layout) {
  std::string text;
  Rows rows;
  std::vector<double> times_s;
  const auto has_place = [](const Metric& metric) { return metric.table == MetricTable::figures; };
  for (const Metric& kind : kinds(comparison, [&](const Metric& m) { return m.time_s && has_place(m); })) {
    add_block(comparison, kind, rows);
    if (times_s.empty()) times_s = times_of(comparison, kind.name);
  }
  if (!rows.empty()) text.append("\n").append(aligned(rows, layout));

  rows.assign(1, {"paired, error norms (standard errors)"});
  for (const double time_s : times_s) rows.back().push_back(fmt::format("{:g} s", time_s));
  add_pairs(comparison, rows);
  if (rows.size() > 1) text.append("\n").append(aligned(rows, layout));

  rows = timeless_rows(comparison, kinds(comparison, [&](const Metric& m) { return !m.time_s && has_place(m); }));
  return rows.empty() ? text : text.append("\n").append(aligned(rows, layout));
}

}  // namespace truebearing
