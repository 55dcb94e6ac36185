#include "truebearing/evaluation/report.hpp"

#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace truebearing {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kPlain = "plain";

// JSON has no NaN: what is not known is null.
Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

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
  if (plain) json["ratio_to_plain"] = by_quantity(summary, [&](const QuantitySummary& q) { return ratio_to(plain, q); });
  for (const auto& [name, ns] : comparison.ns_per_step)
    if (name == summary.name) json["ns_per_step"] = number(ns);
  json["scored_steps"] = summary.scored_steps;
  if (summary.corrected_steps > 0)
    json["correction"] = {{"mean_gate", number(summary.mean_gate)}, {"limited_share", number(summary.limited_share)}};
  json["metrics"] = Json::array();
  json["series"] = series_json(comparison, summary);
  return json;
}

std::string unit_of(const std::string& quantity) {
  const std::size_t underscore = quantity.rfind('_');
  const std::string unit = underscore == std::string::npos ? "" : quantity.substr(underscore + 1);
  return unit == "mps" ? "m/s" : unit;
}

std::string name_of(const std::string& quantity) { return quantity.substr(0, quantity.rfind('_')); }

// Three or four significant digits, without an exponent.
std::string figure(double value) {
  if (!std::isfinite(value)) return "-";
  const double size = std::abs(value);
  return size >= 1000.0 ? fmt::format("{:.0f}", value) : size >= 100.0 ? fmt::format("{:.1f}", value)
       : size >= 10.0   ? fmt::format("{:.2f}", value) : fmt::format("{:.3f}", value);
}

// Columns padded to the widest cell; the first to the left, the others to the right.
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

std::vector<std::string> heading(const Comparison& comparison) {
  std::vector<std::string> row{"tracker"};
  for (const QuantitySummary& quantity : comparison.trackers.front().quantities) {
    row.push_back(fmt::format("{} RMSE {}", name_of(quantity.name), unit_of(quantity.name)));
    row.push_back("+-");
    if (comparison.tracker(kPlain)) row.push_back("/plain");
  }
  row.insert(row.end(), {"NEES", "cover95", "gate", "ns/step"});
  return row;
}

std::vector<std::string> table_row(const Comparison& comparison, const TrackerSummary& summary) {
  const TrackerSummary* plain = comparison.tracker(kPlain);
  std::vector<std::string> row{summary.name};
  for (const QuantitySummary& column : comparison.trackers.front().quantities) {
    const QuantitySummary* quantity = summary.quantity(column.name);
    row.push_back(quantity ? figure(quantity->rmse) : "-");
    row.push_back(quantity ? figure(quantity->rmse_se) : "-");
    if (plain) row.push_back(quantity ? figure(ratio_to(plain, *quantity)) : "-");
  }
  row.push_back(fmt::format("{}/{}", figure(summary.nees), summary.dimension));
  row.push_back(figure(summary.coverage95));
  row.push_back(summary.corrected_steps > 0 ? figure(summary.mean_gate) : "");
  double ns = std::nan("");
  for (const auto& [name, value] : comparison.ns_per_step)
    if (name == summary.name) ns = value;
  row.push_back(std::isfinite(ns) ? fmt::format("{:.0f}", ns) : "");
  return row;
}

}  // namespace

std::string comparison_table(const Comparison& comparison) {
  std::string text = fmt::format("{}: {} runs, seed {}\n\n", comparison.study, comparison.runs, comparison.seed);
  // The columns are those of the tracker with the most quantities, which comes first for the heading.
  Comparison ordered = comparison;
  if (ordered.trackers.empty()) return text;
  std::size_t widest = 0;
  for (std::size_t i = 0; i < ordered.trackers.size(); ++i)
    if (ordered.trackers[i].quantities.size() > ordered.trackers[widest].quantities.size()) widest = i;
  Comparison columns = comparison;
  std::swap(columns.trackers[0], columns.trackers[widest]);
  std::vector<std::vector<std::string>> rows{heading(columns)};
  for (const TrackerSummary& summary : comparison.trackers) rows.push_back(table_row(columns, summary));
  text += aligned(rows);

  if (!comparison.pairs.empty()) {
    rows.assign(1, {"\npaired, per-run RMSE", "", "mean", "+-", "standard errors"});
    for (const Comparison::Pair& pair : comparison.pairs)
      for (const PairedDifference& difference : pair.differences)
        rows.push_back({pair.a + " - " + pair.b, name_of(difference.quantity) + " " + unit_of(difference.quantity),
                        figure(difference.mean), figure(difference.se),
                        std::isfinite(difference.se) && difference.se > 0.0
                            ? fmt::format("{:+.1f}", difference.mean / difference.se) : "-"});
    text += aligned(rows);
  }
  return text;
}

std::string comparison_json(const Comparison& comparison) {
  Json json;
  json["study"] = comparison.study;
  json["seed"] = comparison.seed;
  json["runs"] = comparison.runs;
  json["version"] = TRUEBEARING_VERSION;
  json["trackers"] = Json::object();
  for (const TrackerSummary& summary : comparison.trackers) json["trackers"][summary.name] = tracker_json(comparison, summary);
  json["bounds"] = Json::object();
  for (const std::string& name : comparison.bounds)
    if (const TrackerSummary* bound = comparison.tracker(name)) {
      Json entry = by_quantity(*bound, [](const QuantitySummary& q) { return q.rmse; });
      entry["series"] = series_json(comparison, *bound);
      json["bounds"][name] = entry;
    }
  json["paired"] = Json::object();
  for (const Comparison::Pair& pair : comparison.pairs) {
    Json& entry = json["paired"][pair.a + " - " + pair.b] = Json::object();
    for (const PairedDifference& difference : pair.differences)
      entry[difference.quantity] = {{"mean", number(difference.mean)}, {"se", number(difference.se)}};
  }
  return json.dump(2) + "\n";
}

}  // namespace truebearing
