// SPDX-License-Identifier: Apache-2.0
#include "truebearing/report/log_page.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "truebearing/core/angle.hpp"
#include "truebearing/report/markup.hpp"
#include "truebearing/report/page_parts.hpp"

namespace truebearing {
namespace {

// As many rows as one scrolls through; the JSON has them all.
constexpr std::size_t kMostNotUsed = 200;

// A list of many rows is scrolled, so that what follows it is found.
std::string scrolled(const std::string& head, const std::string& rows) {
  constexpr std::ptrdiff_t kManyRows = 15;
  const bool is_long = std::count(rows.begin(), rows.end(), '\n') > kManyRows;
  return fmt::format(
      "<div class=\"wide{}\" tabindex=\"0\"><table><thead><tr>{}</tr></thead><tbody>\n{}</tbody></table></div>\n",
      is_long ? " long" : "", head, rows);
}

std::string column_heads(std::initializer_list<const char*> names) {
  std::string text;
  for (const char* name : names) text += fmt::format("<th scope=\"col\">{}</th>", name);
  return text;
}

enum class Claim : unsigned char { unknown, consistent, too_small, too_large };

// Of its errors, by the mean NIS.
Claim claim_of(const LogTracker& tracker) {
  if (!(tracker.nis_steps > 0.0) || !std::isfinite(tracker.nis_ratio)) return Claim::unknown;
  if (tracker.nis_ratio > tracker.nis_high) return Claim::too_small;
  return tracker.nis_ratio < tracker.nis_low ? Claim::too_large : Claim::consistent;
}

const char* words_of(Claim claim) {
  switch (claim) {
    case Claim::consistent:
      return "consistent";
    case Claim::too_small:
      return "claims to know more than it does";
    case Claim::too_large:
      return "knows more than it claims";
    case Claim::unknown:
      break;
  }
  return "not known";
}

// "-" where it is not known.
std::string interval_of(double low, double high) {
  return std::isfinite(low) && std::isfinite(high) ? fmt::format("{} to {}", shown(low, 3), shown(high, 3)) : "-";
}

std::string consistency_rows(const LogResults& results) {
  std::string rows;
  for (std::size_t i = 0; i < results.trackers.size(); ++i) {
    const LogTracker& tracker = results.trackers[i];
    rows += fmt::format(
        "<tr><th scope=\"row\"><svg class=\"swatch\" viewBox=\"0 0 28 10\" aria-hidden=\"true\"><path class=\"line {}\" "
        "d=\"M2 5h24\"/></svg>{}</th><td>{}</td><td>{}</td><td>{}</td><td class=\"words\">{}</td><td>{}</td><td>{}</td>",
        tracker_look(i).name, escaped(tracker.name), shown(tracker.steps, 9), shown(tracker.nis_ratio),
        interval_of(tracker.nis_low, tracker.nis_high), words_of(claim_of(tracker)), shown(tracker.correlation, 3),
        interval_of(-tracker.correlation_limit, tracker.correlation_limit));
    for (const auto& [why, count] : tracker.counts) rows += fmt::format("<td>{}</td>", shown(count, 9));
    rows += "</tr>\n";
  }
  return rows;
}

std::string consistency_of(const LogResults& results) {
  if (results.trackers.empty()) return {};
  std::string head = column_heads({"tracker", "steps", "NIS", "95 %", "so it", "correlation", "95 %"});
  for (const auto& [why, count] : results.trackers.front().counts)
    head += fmt::format("<th scope=\"col\">{}</th>", escaped(why));
  std::string text = scrolled(head, consistency_rows(results));
  text +=
      "<p class=\"note\">NIS: mean squared innovation in units of what the tracker claims, by its degrees of freedom. "
      "Correlation: of successive innovations. 95 %: where those of a consistent tracker lie.</p>\n";
  for (const LogTracker& tracker : results.trackers)
    if (!tracker.no_track.empty())
      text += fmt::format("<p class=\"note\">{} began no track: {}</p>\n", escaped(tracker.name),
                          escaped(tracker.no_track));
  return text;
}

// Angles in degrees.
std::pair<std::string, double> unit_for_people(const std::string& component) {
  std::string name = component;
  if (const std::size_t unit = name.rfind("_rad"); unit != std::string::npos) {
    name.replace(unit, 4, "_deg");
    return {name, degrees(1.0)};
  }
  return {name, 1.0};
}

// As many as its standard deviation leaves sense in.
int digits_beside(double value, double sigma) {
  constexpr double kUsual = 4.0, kMost = 12.0;
  if (!(sigma > 0.0) || !(std::abs(value) > 0.0) || !std::isfinite(sigma)) return static_cast<int>(kUsual);
  return static_cast<int>(
      std::clamp(std::floor(std::log10(std::abs(value))) - std::floor(std::log10(sigma)) + 2.0, 1.0, kMost));
}

std::string last_estimates(const LogResults& results, int level) {
  std::vector<std::string> components;
  for (const LogTracker& tracker : results.trackers)
    for (const LogTracker::Last& last : tracker.last)
      for (const auto& [component, value] : last.estimate)
        if (std::find(components.begin(), components.end(), component) == components.end())
          components.push_back(component);
  if (components.empty()) return {};
  std::string head = column_heads({"tracker", "track", "time (s)"}), rows;
  for (const std::string& component : components)
    head += fmt::format("<th scope=\"col\">{}</th>", escaped(unit_for_people(component).first));
  head += "<th scope=\"col\">status</th>";
  for (const LogTracker& tracker : results.trackers)
    for (const LogTracker::Last& last : tracker.last) {
      rows += fmt::format("<tr><th scope=\"row\">{}</th><td>{}</td><td>{}</td>", escaped(tracker.name),
                          shown(last.track, 9), shown(last.time_s, 12));
      for (const std::string& component : components) {
        const double factor = unit_for_people(component).second;
        const auto value_in = [&](const std::vector<std::pair<std::string, double>>& values) {
          for (const auto& [name, value] : values)
            if (name == component) return factor * value;
          return kNaN;
        };
        const double value = value_in(last.estimate), sigma = value_in(last.sigma);
        rows += std::isfinite(value) ? fmt::format("<td>{} <span class=\"se\">± {}</span></td>",
                                                   shown(value, digits_beside(value, sigma)), shown(sigma, 2))
                                     : "<td>-</td>";
      }
      rows += fmt::format("<td>{}</td></tr>\n", escaped(last.status));
    }
  return heading("Last estimates", level) + scrolled(head, rows);
}

std::string events_of(const LogResults& results, int level) {
  std::string rows;
  for (const LogEvent& event : results.events) {
    std::string words = event.event;
    std::replace(words.begin(), words.end(), '_', ' ');
    rows += fmt::format("<tr><td>{}</td><th scope=\"row\">{}</th><td>{}</td><td>{}</td></tr>\n",
                        shown(event.time_s, 12), escaped(event.tracker), escaped(words), shown(event.value, 6));
  }
  if (rows.empty()) return {};
  return heading("What the trackers noticed", level) +
         scrolled(column_heads({"time (s)", "tracker", "what", "value"}), rows);
}

const char* reason_of(const std::string& why) {
  if (why == "missing") return "holds no value";
  if (why == "repeated") return "the same as the one before";
  if (why == "late") return "earlier than the state";
  if (why == "gated") return "outside the gate";
  if (why == "failed") return "the arithmetic could not be carried out";
  return "";
}

std::string not_used_of(const LogResults& results, int level) {
  const std::string title = heading("What was not used", level);
  std::string rows;
  std::size_t count = 0;
  for (const LogTracker& tracker : results.trackers)
    for (const LogTracker::NotUsed& one : tracker.not_used) {
      if (++count > kMostNotUsed) continue;
      rows += fmt::format("<tr><td>{}</td><th scope=\"row\">{}</th><td>{}</td><td>{}</td><td>{}</td></tr>\n",
                          shown(one.time_s, 12), escaped(tracker.name), escaped(one.why), reason_of(one.why),
                          shown(one.nis));
    }
  if (rows.empty()) return title + "<p>Every measurement was used by every tracker.</p>\n";
  std::string text = title + scrolled(column_heads({"time (s)", "tracker", "measurement", "which is", "NIS"}), rows);
  if (count > kMostNotUsed) text += fmt::format("<p class=\"note\">The first {} of {}.</p>\n", kMostNotUsed, count);
  return text;
}

// In a sentence that another may begin.
std::string measurements_of(const LogResults& results) {
  return fmt::format("{} measurements, of which {} miss; {} repeated rows dropped.", shown(results.measurements, 9),
                     shown(results.missing, 9), shown(results.repeated, 9));
}

std::string warnings_of(const LogResults& results) {
  std::string text;
  for (const std::string& warning : results.warnings)
    text += fmt::format("<p class=\"note\">{}</p>\n", escaped(warning));
  return text;
}

// innovations: plots of them. level: of the headings.
std::string found_sections(const LogResults& results, const std::vector<Plot>& innovations, int level) {
  return last_estimates(results, level) + events_of(results, level) + not_used_of(results, level) +
         section("What was not expected", innovations, level);
}

}  // namespace

std::string log_answer(const LogResults& results) {
  std::string text;
  for (const Claim claim : {Claim::consistent, Claim::too_small, Claim::too_large}) {
    std::string names;
    for (const LogTracker& tracker : results.trackers)
      if (claim_of(tracker) == claim) names += (names.empty() ? "" : ", ") + tracker.name;
    if (names.empty()) continue;
    const char* size = claim == Claim::consistent  ? "as large as"
                       : claim == Claim::too_small ? "larger than"
                                                   : "smaller than";
    text += fmt::format("{} {} claimed: {}.", text.empty() ? "Innovations" : " Innovations", size, names);
  }
  return text.empty() ? "No tracker has innovations by which it could be judged." : text;
}

std::string log_page(std::string_view text, const std::string& file) {
  const LogResults results = parse_log_results(text, file);
  std::string body = fmt::format(
      "<h1>{}</h1>\n<p class=\"question\">What can be said without truth? {} on {}</p>\n<p class=\"answer\">{}</p>\n",
      escaped(results.log), escaped(results.study), measurements_of(results), escaped(log_answer(results)));
  body += warnings_of(results) + consistency_of(results) + foretelling_section(results.foretelling);
  std::vector<Plot> plots = log_plots(results), first, rest;
  for (Plot& plot : plots) (plot.id == "tracks" ? first : rest).push_back(std::move(plot));
  body += section("Tracks", first) + found_sections(results, rest, 2);
  body += fmt::format("<footer>Made by truebearing from {} (truebearing {}).</footer>\n", escaped(file),
                      escaped(results.version.empty() ? "of an unknown version" : results.version));
  return html_page(results.log, body);
}

std::string on_log_section(const Results& results, const std::string& id) {
  if (!results.on_log) return {};
  const LogResults& log = *results.on_log;
  const bool of_several = std::isfinite(log.run) && results.runs > 1.0;
  return heading("What the log says without its truth") +
         fmt::format("<p>{}{}</p>\n<p>{}</p>\n", of_several ? fmt::format("Of run {}: ", shown(log.run, 9)) : "",
                     measurements_of(log), escaped(log_answer(log))) +
         warnings_of(log) + consistency_of(log) + found_sections(log, log_plots(log, id), 3);
}

std::vector<PlotFile> log_plot_files(std::string_view text, const std::string& file) {
  std::vector<PlotFile> files;
  for (const Plot& plot : log_plots(parse_log_results(text, file)))
    files.push_back({"log_" + plot.id + ".svg", svg_text(plot, true)});
  return files;
}

}  // namespace truebearing
