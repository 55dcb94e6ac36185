// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/report.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "truebearing/evaluation/details_json.hpp"
#include "truebearing/evaluation/pair_table.hpp"
#include "truebearing/evaluation/share_of_way.hpp"
#include "truebearing/evaluation/text_table.hpp"
#include "truebearing/evaluation/time_table.hpp"
#include "truebearing/evaluation/track_table.hpp"
#include "truebearing/io/json_file.hpp"

namespace truebearing {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kPlain = "plain";

// JSON has no NaN: what is not known is null.
Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json numbers(const std::vector<double>& values) {
  Json array = Json::array();
  for (const double value : values) array.push_back(number(value));
  return array;
}

template <typename Value>
Json by_quantity(const TrackerSummary& summary, const Value& value) {
  Json object = Json::object();
  for (const QuantitySummary& quantity : summary.quantities) object[quantity.name] = number(value(quantity));
  return object;
}

double ratio_to(const TrackerSummary* plain, const QuantitySummary& quantity) {
  const QuantitySummary* other = plain ? plain->quantity(quantity.name) : nullptr;
  return other ? quantity.rmse / other->rmse : std::nan("");
}

Json series_json(const Comparison& comparison, const TrackerSummary& summary) {
  Json rmse = Json::object();
  for (const QuantitySummary& quantity : summary.quantities) rmse[quantity.name] = numbers(quantity.series);
  return {{"time_s", numbers(comparison.time_s)}, {"rmse", rmse}};
}

Json metric_json(const Metric& metric) {
  Json json{{"name", metric.name}, {"unit", metric.unit}};
  if (metric.time_s) json["time_s"] = *metric.time_s;
  json["value"] = number(metric.value);
  json["se"] = number(metric.se);
  return json;
}

// What a tracker has besides: the RMSE of each phase, the largest of the series, and figures at given times.
Json metrics_json(const Comparison& comparison, const TrackerSummary& summary) {
  Json metrics = Json::array();
  for (const QuantitySummary& quantity : summary.quantities) {
    const auto add = [&](const std::string& what, double value, double se) {
      metrics.push_back(metric_json(
          {fmt::format("{}_rmse_{}", name_of(quantity.name), what), unit_of(quantity.name), std::nullopt, value, se}));
    };
    metrics.push_back(metric_json({fmt::format("{}_coverage95", name_of(quantity.name)), "share", std::nullopt,
                                   quantity.coverage95, std::nan("")}));
    for (std::size_t i = 0; i < std::min(quantity.phases.size(), comparison.phases.size()); ++i)
      add(comparison.phases[i], quantity.phases[i].rmse, quantity.phases[i].rmse_se);
    double peak = std::nan("");
    for (const double value : quantity.series) peak = std::fmax(peak, value);
    if (!comparison.phases.empty()) add("peak", peak, std::nan(""));
  }
  for (const Metric& metric : summary.metrics) metrics.push_back(metric_json(metric));
  return metrics;
}

Json tracker_json(const Comparison& comparison, const TrackerSummary& summary) {
  const TrackerSummary* plain = comparison.tracker(kPlain);
  Json json;
  json["rmse"] = by_quantity(summary, [](const QuantitySummary& q) { return q.rmse; });
  json["rmse_se"] = by_quantity(summary, [](const QuantitySummary& q) { return q.rmse_se; });
  json["median"] = by_quantity(summary, [](const QuantitySummary& q) { return q.median; });
  json["loss_rate"] = number(summary.loss_rate);
  json["nees"] = number(summary.nees);
  json["nees_expected"] = summary.dimension;
  json["coverage95"] = number(summary.coverage95);
  if (plain)
    json["ratio_to_plain"] = by_quantity(summary, [&](const QuantitySummary& q) { return ratio_to(plain, q); });
  if (const WayToBound way = way_to_bound(comparison))
    json["share_of_way"] = by_quantity(summary, [&](const QuantitySummary& q) { return way.share(summary, q.name); });
  for (const auto& [name, ns] : comparison.ns_per_step)
    if (name == summary.name) json["ns_per_step"] = number(ns);
  json["scored_steps"] = summary.scored_steps;
  if (summary.corrected_steps > 0)
    json["correction"] = {{"mean_gate", number(summary.mean_gate)}, {"limited_share", number(summary.limited_share)}};
  json["metrics"] = metrics_json(comparison, summary);
  json["series"] = series_json(comparison, summary);
  return json;
}

Json angle_bound_json(const Comparison& comparison, const AngleBoundSummary& bound) {
  Json entry, rmse = Json::object(), metrics = Json::array();
  for (const AngleBoundSummary::Quantity& quantity : bound.quantities) {
    entry[quantity.name] = number(quantity.rmse);
    metrics.push_back(metric_json(quantity.mse));
    rmse[quantity.name] = numbers(quantity.series);
  }
  entry["metrics"] = metrics;
  entry["series"] = {{"time_s", numbers(comparison.time_s)}, {"rmse", rmse}};
  return entry;
}

Json published_json(const std::vector<PublishedRow>& rows) {
  Json json = Json::object();
  for (const PublishedRow& row : rows) {
    json[row.name]["source"] = row.source;
    for (const PublishedFigure& figure : row.figures) json[row.name][figure.name] = figure.value;
  }
  return json;
}

using Columns = std::vector<QuantitySummary>;

// The quantities of the tracker that has most of them: a raw measurement may lack the velocity.
const Columns& quantities_of(const Comparison& comparison) {
  const auto most =
      std::max_element(comparison.trackers.begin(), comparison.trackers.end(),
                       [](const auto& a, const auto& b) { return a.quantities.size() < b.quantities.size(); });
  return most->quantities;
}

std::vector<std::string> heading(const Comparison& comparison) {
  std::vector<std::string> row{"tracker"};
  for (const QuantitySummary& quantity : quantities_of(comparison)) {
    row.push_back(fmt::format("{} RMSE {}", name_of(quantity.name), unit_of(quantity.name)));
    row.push_back("+-");
    if (comparison.tracker(kPlain)) row.push_back("/plain");
    if (const WayToBound way = way_to_bound(comparison)) row.push_back("way to " + way.to->name);
  }
  row.insert(row.end(), {"NEES", "cover95"});
  if (quantities_of(comparison).size() > 1)
    for (const QuantitySummary& quantity : quantities_of(comparison))
      row.push_back(fmt::format("({})", name_of(quantity.name)));
  row.push_back("gate");
  if (!comparison.ns_per_step.empty()) row.push_back("ns/step");
  return row;
}

bool is_bound(const Comparison& comparison, const std::string& name) {
  return std::find(comparison.bounds.begin(), comparison.bounds.end(), name) != comparison.bounds.end();
}

// With the least RMSE in that quantity of several that are no bounds.
bool is_best(const Comparison& comparison, const TrackerSummary& summary, const std::string& quantity) {
  const QuantitySummary* of = summary.quantity(quantity);
  if (!of || !std::isfinite(of->rmse) || is_bound(comparison, summary.name)) return false;
  bool has_others = false;
  for (const TrackerSummary& other : comparison.trackers) {
    const QuantitySummary* its = other.quantity(quantity);
    if (&other == &summary || !its || is_bound(comparison, other.name)) continue;
    has_others = true;
    if (its->rmse < of->rmse) return false;
  }
  return has_others;
}

std::vector<std::string> table_row(const Comparison& comparison, const TrackerSummary& summary,
                                   const TableLayout& layout) {
  const TrackerSummary* plain = comparison.tracker(kPlain);
  std::vector<std::string> row{is_bound(comparison, summary.name) ? summary.name + " (bound)" : summary.name};
  for (const QuantitySummary& column : quantities_of(comparison)) {
    const QuantitySummary* quantity = summary.quantity(column.name);
    row.push_back(
        marked(quantity ? fine_figure(quantity->rmse) : "-", is_best(comparison, summary, column.name), layout));
    row.push_back(quantity ? fine_figure(quantity->rmse_se) : "-");
    if (plain) row.push_back(quantity ? figure(ratio_to(plain, *quantity)) : "-");
    if (const WayToBound way = way_to_bound(comparison)) {
      const double share = way.share(summary, column.name);
      row.push_back(std::isfinite(share) ? fmt::format("{:.3f}", share) : "-");
    }
  }
  row.push_back(fmt::format("{}/{}", figure(summary.nees), summary.dimension));
  row.push_back(figure(summary.coverage95));
  if (quantities_of(comparison).size() > 1)
    for (const QuantitySummary& column : quantities_of(comparison)) {
      const QuantitySummary* quantity = summary.quantity(column.name);
      row.push_back(quantity ? figure(quantity->coverage95) : "-");
    }
  row.push_back(summary.corrected_steps > 0 ? figure(summary.mean_gate) : "");
  for (const auto& [name, ns] : comparison.ns_per_step)
    if (name == summary.name) row.push_back(fmt::format("{:.0f}", ns));
  return row;
}

// What of that table was published; no row where that is nothing.
void add_published(const Comparison& comparison, const TableLayout& layout,
                   std::vector<std::vector<std::string>>& rows) {
  const auto cell = [](std::optional<double> value) { return value ? figure(*value) : "-"; };
  for (const PublishedRow& published : comparison.published) {
    bool has_any = published.figure("nees").has_value();
    std::vector<std::string> row{published_title(published)};
    for (const QuantitySummary& column : quantities_of(comparison)) {
      const std::optional<double> rmse = published.figure(column.name);
      has_any |= rmse.has_value();
      row.insert(row.end(), {marked(cell(rmse), false, layout), "-"});
      if (comparison.tracker(kPlain)) row.emplace_back("-");
      if (way_to_bound(comparison)) row.emplace_back("-");
    }
    row.push_back(cell(published.figure("nees")));
    if (has_any) rows.push_back(std::move(row));
  }
}

// RMSE by phase, where the scenario tells phases apart.
std::string phase_table(const Comparison& comparison, const TableLayout& layout) {
  if (comparison.phases.empty()) return {};
  std::vector<std::vector<std::string>> rows(1, {"RMSE by phase"});
  for (const QuantitySummary& column : quantities_of(comparison))
    for (const std::string& phase : comparison.phases)
      rows[0].push_back(fmt::format("{} {} {}", phase, name_of(column.name), unit_of(column.name)));
  for (const TrackerSummary& summary : comparison.trackers) {
    rows.push_back({summary.name});
    for (const QuantitySummary& column : quantities_of(comparison)) {
      const QuantitySummary* quantity = summary.quantity(column.name);
      for (std::size_t i = 0; i < comparison.phases.size(); ++i)
        rows.back().push_back(quantity && i < quantity->phases.size() ? figure(quantity->phases[i].rmse) : "-");
    }
  }
  return fmt::format("\n{}", aligned(rows, layout));
}

std::string tables(const Comparison& comparison, const TableLayout& layout) {
  std::vector<std::vector<std::string>> rows{heading(comparison)};
  for (const TrackerSummary& summary : comparison.trackers) rows.push_back(table_row(comparison, summary, layout));
  add_published(comparison, layout, rows);
  return aligned(rows, layout) + track_tables(comparison, layout) + phase_table(comparison, layout) +
         time_tables(comparison, layout) + pair_table("paired, per-run RMSE", comparison, MetricTable::figures, layout);
}

std::string heading_line(const std::string& name, const TableLayout& layout) {
  return layout.markdown ? name + "\n\n" : name + "\n";
}

// Where what was published is printed, each source once.
std::string sources(const Comparison& comparison) {
  std::vector<PublishedRow> rows = comparison.published;
  for (const auto& [name, set] : comparison.sets) rows.insert(rows.end(), set.published.begin(), set.published.end());
  std::vector<std::string> lines;
  for (const PublishedRow& row : rows)
    if (std::string line = fmt::format("{}: {}\n", published_title(row), row.source);
        std::find(lines.begin(), lines.end(), line) == lines.end())
      lines.push_back(std::move(line));
  return lines.empty() ? "" : fmt::format("\n{}", fmt::join(lines, ""));
}

// What a comparison, or one set of it, has to say besides where it comes from.
void add_figures(const Comparison& comparison, Json& json) {
  json["trackers"] = Json::object();
  for (const TrackerSummary& summary : comparison.trackers)
    json["trackers"][summary.name] = tracker_json(comparison, summary);
  json["bounds"] = Json::object();
  for (const std::string& name : comparison.bounds)
    if (const TrackerSummary* bound = comparison.tracker(name)) {
      Json entry = by_quantity(*bound, [](const QuantitySummary& q) { return q.rmse; });
      entry["series"] = series_json(comparison, *bound);
      json["bounds"][name] = entry;
    }
  if (comparison.cramer_rao) {
    Json& entry = json["bounds"]["cramer_rao"];
    entry["position_m"] = number(comparison.cramer_rao->position_m);
    entry["velocity_mps"] = number(comparison.cramer_rao->velocity_mps);
    entry["metrics"] = Json::array();
    for (const Metric& metric : comparison.cramer_rao->metrics) entry["metrics"].push_back(metric_json(metric));
  }
  for (const AngleBoundSummary& bound : comparison.angle_bounds)
    json["bounds"][bound.name] = angle_bound_json(comparison, bound);
  if (!comparison.published.empty()) json["published"] = published_json(comparison.published);
  json["paired"] = Json::object();
  for (const Comparison::Pair& pair : comparison.pairs) {
    Json& entry = json["paired"][pair.a + " - " + pair.b] = Json::object();
    for (const PairedDifference& difference : pair.differences)
      if (difference.time_s)
        entry["at_times"].push_back({{"quantity", difference.quantity},
                                     {"time_s", *difference.time_s},
                                     {"mean", number(difference.mean)},
                                     {"se", number(difference.se)}});
      else
        entry[difference.quantity] = {{"mean", number(difference.mean)}, {"se", number(difference.se)}};
  }
}

}  // namespace

std::string comparison_table(const Comparison& comparison, const TableLayout& layout) {
  std::string text = fmt::format("{}: {} run{}, seed {}\n\n", comparison.study, comparison.runs,
                                 comparison.runs == 1 ? "" : "s", comparison.seed);
  if (comparison.trackers.empty()) return text;
  for (const auto& [name, set] : comparison.sets) text += heading_line(name, layout) + tables(set, layout) + "\n";
  if (!comparison.sets.empty()) text += heading_line("all sets together", layout);
  return text + tables(comparison, layout) + sources(comparison);
}

std::string comparison_json(const Comparison& comparison, const std::vector<RunPicture>& pictures, const Json* on_log) {
  Json json;
  json["study"] = comparison.study;
  json["seed"] = comparison.seed;
  json["runs"] = comparison.runs;
  json["version"] = TRUEBEARING_VERSION;
  add_figures(comparison, json);
  for (const auto& [name, set] : comparison.sets) add_figures(set, json["sets"][name]);
  add_details(comparison, pictures, json);
  if (on_log) json["on_log"] = *on_log;
  return json_text(json);
}

}  // namespace truebearing
