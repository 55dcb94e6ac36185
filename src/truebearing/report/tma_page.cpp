// SPDX-License-Identifier: Apache-2.0
#include "truebearing/report/tma_page.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "truebearing/core/chi_square.hpp"
#include "truebearing/io/json_file.hpp"
#include "truebearing/report/consistency_plot.hpp"
#include "truebearing/report/markup.hpp"
#include "truebearing/report/page_parts.hpp"
#include "truebearing/report/plot_clock.hpp"
#include "truebearing/report/result_reader.hpp"

namespace truebearing {
namespace {

constexpr JsonLimits kTmaLimits{std::size_t{1} << 28, 64};
// Bearing lines beyond some dozens cover each other.
constexpr std::size_t kMostTmaSights = 60;

// A straight course between two times, of a state [east, north, east_mps, north_mps] at the later one.
PlotSeries course_of(const ResultReader& state, const std::string& name, const Look& look, double duration_s) {
  const double east = state.at("east_m").number(), north = state.at("north_m").number();
  const double east_mps = state.at("east_mps").number(), north_mps = state.at("north_mps").number();
  return {name, look, Shape::line, {east - duration_s * east_mps, east}, {north - duration_s * north_mps, north}};
}

Plot plane_plot(const ResultReader& json) {
  const ResultReader details = json.at("details");
  Plot plot;
  plot.id = "plane";
  plot.title = "Own ship, bearings and target";
  plot.x_label = "East (m)";
  plot.y_label = "North (m)";
  plot.equal = true;
  plot.caption =
      "Each target's course is that of the estimate from the first bearing to the last, where its ellipse of "
      "two standard deviations stands.";
  const std::vector<double> east = details.at("own_east_m").numbers(), north = details.at("own_north_m").numbers();
  const std::vector<double> bearing_deg = details.at("bearing_deg").numbers();
  if (east.size() != north.size() || east.size() != bearing_deg.size())
    throw details.error("has columns of unequal length");
  PlotSeries sights{"bearing", {"measured"}, Shape::sights, {}, {}, {}};
  const std::size_t every = east.size() / (kMostTmaSights + 1) + 1;
  for (std::size_t i = 0; i < east.size(); i += every) {
    sights.x.push_back(east[i]);
    sights.y.push_back(north[i]);
    sights.y2.push_back(bearing_deg[i]);
  }
  plot.series.push_back(std::move(sights));
  plot.series.push_back({"own ship", {"own"}, Shape::line, east, north});
  const double duration_s = json.at("time_s").number() - json.at("from_s").number();
  if (json.has("truth")) plot.series.push_back(course_of(json.at("truth"), "truth", {"truth"}, duration_s));
  // Where the range is open, ranges over some decades explain the bearings: the farthest would leave nothing to see of
  // the others.
  constexpr double kFarthest = 10.0;
  bool first = true;
  double nearest_m = kInfinity;
  for (const ResultReader& other : json.at("hypotheses").items())
    nearest_m = std::min(nearest_m, other.at("range_m").number());
  for (const char* key : {"ambiguities", "hypotheses"})
    for (const ResultReader& other : json.at(key).items()) {
      if (other.at("range_m").number() > kFarthest * nearest_m) continue;
      plot.series.push_back(course_of(other, first ? "also possible" : "", tracker_look(1), duration_s));
      first = false;
    }
  PlotSeries target = course_of(json.at("estimate"), "target", tracker_look(0), duration_s);
  const std::vector<ResultReader> covariance = json.at("covariance").items();
  if (covariance.size() != 4) throw json.error("has a covariance that is not 4 by 4");
  const std::vector<double> row = covariance[0].numbers(), second = covariance[1].numbers();
  if (row.size() != 4 || second.size() != 4) throw json.error("has a covariance that is not 4 by 4");
  plot.series.push_back(
      {"", target.look, Shape::ellipses, {target.x[1]}, {target.y[1]}, {}, {row[0]}, {row[1]}, {second[1]}});
  plot.series.push_back({"", target.look, Shape::dots, {target.x[1]}, {target.y[1]}});
  plot.series.push_back(std::move(target));
  return plot;
}

Plot residual_plot(const ResultReader& json) {
  const ResultReader details = json.at("details");
  Plot plot;
  plot.id = "residuals";
  plot.title = "What is left of the bearings";
  plot.y_label = "residual (standard deviations)";
  plot.caption =
      "Measured bearing minus that of the estimate. 19 of 20 lie in the band where one course and speed "
      "explains them; what bends away from nothing is a manoeuvre, a bias or another contact.";
  const std::vector<double> time_s = details.at("time_s").numbers();
  if (time_s.empty()) return plot;
  constexpr double kOf95Percent = 1.96;
  const PlotClock clock(time_s);
  plot.x_label = clock.label;
  const std::vector<double> ends = clock.from({time_s.front(), time_s.back()});
  plot.series.push_back(
      {"95 %", {"measured"}, Shape::band, ends, {-kOf95Percent, -kOf95Percent}, {kOf95Percent, kOf95Percent}});
  plot.series.push_back({"", {"ideal"}, Shape::line, ends, {0.0, 0.0}});
  const std::vector<double> residuals = details.at("residual_sigmas").numbers();
  if (residuals.size() != time_s.size()) throw details.error("has columns of unequal length");
  plot.series.push_back({"a bearing", tracker_look(0), Shape::dots, clock.from(time_s), residuals});
  PlotSeries outliers{"outlier", tracker_look(1), Shape::dots, {}, {}};
  for (const ResultReader& outlier : json.at("outliers").at("bearings").items()) {
    const auto at = std::find(time_s.begin(), time_s.end(), outlier.at("time_s").number());
    if (at == time_s.end()) continue;
    outliers.x.push_back(*at - clock.zero_s);
    outliers.y.push_back(residuals.at(static_cast<std::size_t>(at - time_s.begin())));
  }
  if (!outliers.x.empty()) plot.series.push_back(std::move(outliers));
  return plot;
}

// Of the bearings by themselves: one degree of freedom each.
Plot tma_consistency_plot(const ResultReader& json) {
  const ResultReader details = json.at("details");
  SquaredResiduals squares{details.at("time_s").numbers(), details.at("residual_sigmas").numbers(), {}};
  squares.freedom.assign(squares.time_s.size(), 1.0);
  for (double& residual : squares.nis) residual *= residual;
  Plot plot = consistency_plot(squares, "bearings");
  plot.id = "consistency";
  plot.title = "Do the bearings err as much as they claim?";
  return plot;
}

std::string tma_table(std::initializer_list<const char*> names, const std::string& rows) {
  std::string head;
  for (const char* name : names) head += fmt::format("<th scope=\"col\">{}</th>", name);
  return fmt::format(
      "<div class=\"wide\" tabindex=\"0\"><table><thead><tr>{}</tr></thead><tbody>\n{}</tbody></table></div>\n", head,
      rows);
}

// Whether one course and speed explains the bearings, by what it leaves of them.
std::string residual_table(const ResultReader& json) {
  if (!json.has("residuals")) return {};
  const ResultReader residuals = json.at("residuals");
  const auto row = [](const char* what, double value, const std::string& expected, bool good, const char* otherwise) {
    return fmt::format("<tr><th scope=\"row\">{}</th><td>{}</td><td>{}</td><td>{}</td></tr>\n", what, shown(value),
                       expected, good ? "as expected" : otherwise);
  };
  const double freedom = residuals.at("degrees_of_freedom").number(),
               ratio = residuals.at("chi_square").number() / freedom;
  constexpr double kMostFreedom = 1e9;
  if (!(freedom >= 1.0 && freedom <= kMostFreedom) || !std::isfinite(ratio)) return {};
  const ChiSquareMeans consistent = chi_square_means(freedom, 1.0);
  std::string rows =
      row("squared residuals by their degrees of freedom", ratio,
          fmt::format("{} to {}", shown(consistent.low), shown(consistent.high)),
          ratio >= consistent.low && ratio <= consistent.high, ratio > consistent.high ? "too large" : "too small");
  constexpr double kLagLimit = 1.96;
  const double lag = residuals.at("lag_one_sigmas").number();
  if (std::isfinite(lag))
    rows += row("correlation of successive ones (standard deviations)", lag,
                fmt::format("{} to {}", shown(-kLagLimit), shown(kLagLimit)), std::abs(lag) <= kLagLimit, "not white");
  return tma_table({"residuals", "value", "95 % where all is right", "so"}, rows);
}

// Bearings and frequencies that were not believed, with what speaks against them.
std::string outlier_table(const ResultReader& json) {
  std::string rows;
  const ResultReader outliers = json.at("outliers");
  for (const auto& [key, what] : {std::pair{"bearings", "bearing"}, {"frequencies", "frequency"}}) {
    if (!outliers.has(key)) continue;
    for (const ResultReader& one : outliers.at(key).items()) {
      const double or_line = one.number_or_nan("or_line"), sigmas = one.number_or_nan("sigmas");
      std::string why = std::isfinite(sigmas)
                            ? fmt::format("{} standard deviations off what the others say", shown(sigmas, 3))
                            : "off what the others say";
      if (std::isfinite(or_line)) why += fmt::format("; or line {} in its stead", shown(or_line, 9));
      rows += fmt::format("<tr><td>{}</td><th scope=\"row\">{}</th><td>{}</td><td>{}</td></tr>\n",
                          shown(one.at("time_s").number(), 12), what, shown(one.number_or_nan("line"), 9), why);
    }
  }
  const double missing = json.number_or_nan("missing");
  const std::string note =
      missing > 0.0 ? fmt::format("<p class=\"note\">{} no bearing.</p>\n",
                                  missing > 1.0 ? shown(missing, 9) + " rows hold" : std::string("One row holds"))
                    : "";
  if (rows.empty()) return "<h2>What was rejected</h2>\n<p>No bearing stands out from the others.</p>\n" + note;
  return "<h2>What was rejected</h2>\n" + tma_table({"time (s)", "what", "line of the log", "why"}, rows) + note;
}

std::string stretch_motion(const ResultReader& stretch) {
  const ResultReader motion = stretch.at("estimate");
  if (!motion.has("range_m")) return "range not determined";
  return fmt::format("{} m, course {} deg, {} m/s", shown(motion.at("range_m").number()),
                     shown(motion.at("course_deg").number()), shown(motion.at("speed_mps").number(), 3));
}

std::string tma_events(const ResultReader& json) {
  std::string rows;
  const auto row = [&](double time_s, const std::string& what, const std::string& more) {
    rows += fmt::format("<tr><td>{}</td><th scope=\"row\">{}</th><td>{}</td></tr>\n", shown(time_s, 12), what, more);
  };
  if (json.has("manoeuvre") && json.at("manoeuvre").at("detected").truth() && json.at("manoeuvre").has("earliest_s")) {
    const ResultReader manoeuvre = json.at("manoeuvre");
    row(manoeuvre.at("time_s").number(), "the target left its course or speed",
        fmt::format("between {} and {} s", shown(manoeuvre.at("earliest_s").number(), 12),
                    shown(manoeuvre.at("latest_s").number(), 12)));
    for (const ResultReader& stretch : manoeuvre.at("stretches").items())
      row(stretch.at("from_s").number(), fmt::format("to {} s by itself", shown(stretch.at("to_s").number(), 12)),
          stretch_motion(stretch));
  }
  if (json.has("source"))
    for (const ResultReader& change : json.at("source").at("changes").items())
      row(change.at("time_s").number(), "the source's frequency jumped",
          fmt::format("to {} Hz", shown(change.at("frequency_hz").number(), 6)));
  return rows.empty() ? "" : "<h2>What happened</h2>\n" + tma_table({"time (s)", "what", "more"}, rows);
}

std::string solution_table(const ResultReader& json) {
  struct Row {
    const char *key, *name, *unit;
  };
  constexpr Row kRows[] = {{"range_m", "range", "m"},
                           {"bearing_deg", "bearing", "deg"},
                           {"course_deg", "course", "deg"},
                           {"speed_mps", "speed", "m/s"},
                           {"frequency_hz", "frequency of the source", "Hz"}};
  const ResultReader estimate = json.at("estimate"), sigma = json.at("standard_deviation");
  const bool with_truth = json.has("truth");
  std::string rows;
  for (const Row& row : kRows) {
    if (!estimate.has(row.key)) continue;
    rows += fmt::format("<tr><th scope=\"row\">{}</th><td>{} <span class=\"se\">± {}</span></td><td>{}</td>", row.name,
                        shown(estimate.at(row.key).number(), 5), shown(sigma.number_or_nan(row.key), 2), row.unit);
    if (with_truth) rows += fmt::format("<td>{}</td>", shown(json.at("truth").number_or_nan(row.key), 5));
    rows += "</tr>\n";
  }
  return fmt::format(
      "<div class=\"wide\" tabindex=\"0\"><table><thead><tr><th scope=\"col\">at the last bearing</th><th "
      "scope=\"col\">estimate</th><th scope=\"col\">unit</th>{}</tr></thead><tbody>\n{}</tbody></table></div>\n",
      with_truth ? "<th scope=\"col\">truth</th>" : "", rows);
}

std::vector<Plot> plots_of(const ResultReader& json) {
  std::vector<Plot> plots;
  for (Plot plot : {plane_plot(json), residual_plot(json), tma_consistency_plot(json)})
    if (!plot.empty()) plots.push_back(std::move(plot));
  return plots;
}

}  // namespace

std::vector<Plot> tma_plots(std::string_view text, const std::string& file) {
  const nlohmann::ordered_json parsed = parse_ordered_json(text, file, kTmaLimits);
  return plots_of(ResultReader(parsed, file));
}

std::string tma_page(std::string_view text, const std::string& file) {
  const nlohmann::ordered_json parsed = parse_ordered_json(text, file, kTmaLimits);
  const ResultReader json(parsed, file);
  const std::string log = json.at("log").text();
  std::string body = fmt::format(
      "<h1>{}</h1>\n<p class=\"question\">Where is the target, and where does it go? {} bearings over {} s, method "
      "{}.</p>\n<p class=\"answer\">{}</p>\n",
      escaped(log), shown(json.at("bearings").number(), 9),
      shown(json.at("time_s").number() - json.at("from_s").number(), 5), escaped(json.at("method").text()),
      escaped(json.at("verdict").text()));
  body += solution_table(json) + residual_table(json);
  std::string causes;
  for (const ResultReader& cause : json.at("causes").items())
    causes += fmt::format("<li>{}</li>\n", escaped(cause.at("says").text()));
  if (!causes.empty()) body += fmt::format("<h2>What the bearings look like besides</h2>\n<ul>\n{}</ul>\n", causes);
  body += section("In the plane, and what is left", plots_of(json)) + tma_events(json) + outlier_table(json);
  return html_page(log, body);
}

std::vector<PlotFile> tma_plot_files(std::string_view text, const std::string& file) {
  std::vector<PlotFile> files;
  for (const Plot& plot : tma_plots(text, file)) files.push_back({"tma_" + plot.id + ".svg", svg_text(plot, true)});
  return files;
}

}  // namespace truebearing
