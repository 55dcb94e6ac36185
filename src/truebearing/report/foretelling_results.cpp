// SPDX-License-Identifier: Apache-2.0
#include "truebearing/report/foretelling_results.hpp"

#include <fmt/format.h>

#include "truebearing/evaluation/metric.hpp"
#include "truebearing/report/markup.hpp"
#include "truebearing/report/result_reader.hpp"

namespace truebearing {
namespace {

std::string with_error(double value, double se) {
  return fmt::format("<td>{} <span class=\"se\">± {}</span></td>", shown(value), shown(se, 2));
}

std::string row_of(const ForetellingResults& told, const ForetellingResults::Tracker& tracker) {
  const bool is_best = tracker.name == told.best;
  std::string row = fmt::format("<tr><th scope=\"row\">{}{}</th>", escaped(tracker.name),
                                is_best ? "<span class=\"tag\">best</span>" : "") +
                    with_error(tracker.rmse, tracker.rmse_se);
  if (is_best) return row + "<td>-</td><td>-</td></tr>\n";
  const double errors = tracker.above_best_se > 0.0 ? tracker.above_best / tracker.above_best_se : kNaN;
  return row + with_error(tracker.above_best, tracker.above_best_se) +
         fmt::format("<td>{}</td></tr>\n", shown(errors, 2));
}

std::string table_of(const ForetellingResults& told) {
  std::string text = fmt::format(
      "<div class=\"wide\" tabindex=\"0\"><table><thead><tr><th scope=\"col\">tracker</th><th scope=\"col\">{} RMSE ({})"
      "</th><th scope=\"col\">squared, above the best ({})</th><th scope=\"col\">in standard errors</th></tr></thead><tbody>\n",
      escaped(name_of(told.quantity)), escaped(unit_of(told.quantity)), escaped(squared_unit_of(told.quantity)));
  for (const ForetellingResults::Tracker& tracker : told.trackers) text += row_of(told, tracker);
  text += "</tbody></table></div>\n";
  text += fmt::format(
      "<p class=\"note\">{} measurements, each {} of the trackers' steps ahead, of halves of the log that were hidden in "
      "turn. Their own noise is in every error alike; the differences are the trackers'.</p>\n",
      shown(told.measurements, 9), shown(told.steps, 9));
  for (const std::string& name : told.left_out)
    text += fmt::format("<p class=\"note\">{} has no estimate where measurements are hidden.</p>\n", escaped(name));
  constexpr double kShut = 0.05;
  for (const ForetellingResults::Tracker& tracker : told.trackers)
    if (tracker.mean_gate < kShut)
      text += fmt::format(
          "<p class=\"note\">{}: its gate is shut where measurements are hidden; its figure is that of what it "
          "trusts.</p>\n",
          escaped(tracker.name));
  return text;
}

}  // namespace

std::vector<ForetellingResults> read_foretelling(const ResultReader& results) {
  std::vector<ForetellingResults> all;
  if (!results.has("foretelling")) return all;
  for (const ResultReader& json : results.at("foretelling").items()) {
    ForetellingResults told{json.at("track").number(),  json.at("steps").number(), json.at("measurements").number(),
                            json.at("quantity").text(), json.at("best").text(),    json.at("says").text()};
    for (const ResultReader& name : json.at("left_out").items()) told.left_out.push_back(name.text());
    for (const auto& [name, tracker] : json.at("trackers").entries())
      told.trackers.push_back({name, tracker.at("rmse").number(), tracker.at("rmse_se").number(),
                               tracker.at("squared_above_best").number(), tracker.at("squared_above_best_se").number(),
                               tracker.at("mean_gate").number()});
    all.push_back(std::move(told));
  }
  return all;
}

std::string foretelling_section(const std::vector<ForetellingResults>& all) {
  if (all.empty()) return {};
  std::string text = "<h2>Who foretells best</h2>\n";
  for (const ForetellingResults& told : all) {
    if (all.size() > 1) text += fmt::format("<h3>Track {}</h3>\n", shown(told.track, 9));
    if (!told.says.empty()) text += fmt::format("<p>{}.</p>\n", escaped(told.says));
    text += table_of(told);
  }
  return text;
}

}  // namespace truebearing
