// SPDX-License-Identifier: Apache-2.0
#include "truebearing/report/page.hpp"

#include <algorithm>
#include <fmt/format.h>

#include "truebearing/report/correction_plots.hpp"
#include "truebearing/report/correction_tables.hpp"
#include "truebearing/report/log_page.hpp"
#include "truebearing/report/markup.hpp"
#include "truebearing/report/page_parts.hpp"
#include "truebearing/report/plot.hpp"
#include "truebearing/report/result_tables.hpp"
#include "truebearing/report/study_plots.hpp"
#include "truebearing/report/verdict.hpp"

namespace truebearing {
namespace {

// Plots beyond these stand folded.
constexpr std::size_t kOpenMetricPlots = 8;

std::string metric_section(const ResultFigures& figures, const std::string& id) {
  std::vector<Plot> plots = metric_plots(figures, id), more;
  if (plots.size() > kOpenMetricPlots) {
    more.assign(plots.begin() + kOpenMetricPlots, plots.end());
    plots.resize(kOpenMetricPlots);
  }
  return section("At the scored times", plots) +
         folded("More figures at the scored times", section("More figures", more));
}

std::string figures_sections(const ResultFigures& figures, const std::string& id) {
  return section("Against time", time_plots(figures, id)) + metric_section(figures, id) +
         section("Run by run", run_plots(figures, id));
}

// What each correction did. timed: its steps are those of one set. open: the features of the first one stand unfolded.
std::string correction_section(const ResultFigures& figures, const std::string& id, bool timed, bool open) {
  std::string text;
  for (std::size_t i = 0; i < figures.trackers.size(); ++i) {
    const ResultTracker& tracker = figures.trackers[i];
    if (!tracker.correction) continue;
    const ResultCorrection& correction = *tracker.correction;
    std::vector<Plot> plots = timed ? correction_time_plots(figures, i, id) : std::vector<Plot>{};
    for (Plot& plot : rule_plots(figures, i, id)) plots.push_back(std::move(plot));
    const std::string features = feature_table(correction) + figures_markup(feature_plots(figures, i, id));
    const bool unfolded = open && text.empty();
    text +=
        fmt::format("<h3>{}</h3>\n", escaped(tracker.name)) + correction_sentence(correction) + figures_markup(plots);
    text += folded(fmt::format("The {} rules of {}", correction.rules.size(), tracker.name), rule_table(correction));
    text += unfolded ? features : folded(fmt::format("The features of {}", tracker.name), features);
  }
  return text.empty() ? "" : "<h2>What the corrections did</h2>\n" + text;
}

std::string results_section(const Results& results, const std::string& id, bool alone) {
  std::string text = alone ? fmt::format("<h1>{}</h1>\n", escaped(results.study))
                           : fmt::format("<h1>{}: {}</h1>\n", escaped(results.file), escaped(results.study));
  text += fmt::format("<p class=\"question\">{}</p>\n<p class=\"answer\">{}</p>\n", escaped(question(results)),
                      escaped(answer(results)));
  if (!results.sets.empty()) text += "<p class=\"note\">Of all sets together; each by itself below.</p>\n";
  text += tracker_table(results.all);
  text += "<p class=\"note\">± is the standard error over runs. Best: the least RMSE among what is no bound.</p>\n";
  text += published_table(results.all) + paired_table(results.all, true);
  text += folded("Further figures", paired_table(results.all, false) + metric_table(results.all));
  text += foretelling_section(results.foretelling);
  // Steps of several sets do not lie at the same times.
  text += results.sets.empty() ? figures_sections(results.all, id) : section("Run by run", run_plots(results.all, id));
  text += section("Runs as they happened", picture_plots(results, id)) + on_log_section(results, id);
  text += correction_section(results.all, id, results.sets.empty(), true);
  for (std::size_t i = 0; i < results.sets.size(); ++i) {
    const Results::Set& set = results.sets[i];
    text += fmt::format("<h2>{}</h2>\n", escaped(set.name)) + tracker_table(set.figures) +
            published_table(set.figures) + paired_table(set.figures, true);
    text += figures_sections(set.figures, fmt::format("{}set{}_", id, i + 1));
    text += correction_section(set.figures, fmt::format("{}set{}_", id, i + 1), true, false);
  }
  return text;
}

std::string id_of(const std::vector<Results>& all, std::size_t i) {
  return all.size() > 1 ? fmt::format("file{}_", i + 1) : "";
}

// What a file's name may hold on any system.
std::string file_name(const std::string& text) {
  std::string name;
  for (const char c : text) {
    const bool plain =
        (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
    name += plain ? c : '_';
  }
  return name;
}

}  // namespace

std::string report_page(const std::vector<Results>& all) {
  std::string title;
  for (const Results& results : all)
    if (title.find(results.study) == std::string::npos) title += (title.empty() ? "" : ", ") + results.study;
  std::string page;
  if (all.size() > 1)
    page +=
        "<h1>Side by side</h1>\n" + side_by_side_table(all) +
        "<p class=\"note\">Changes are from the first file; those beyond two standard errors are marked ▲ or ▼.</p>\n";
  for (std::size_t i = 0; i < all.size(); ++i) page += results_section(all[i], id_of(all, i), all.size() == 1);
  std::string from;
  for (const Results& results : all)
    from += fmt::format("{}{} (truebearing {})", from.empty() ? "" : ", ", results.file,
                        results.version.empty() ? "of an unknown version" : results.version);
  page += fmt::format("<footer>Made by truebearing from {}.</footer>\n", escaped(from));
  return html_page(title, page);
}

std::vector<PlotFile> plot_files(const std::vector<Results>& all) {
  std::vector<PlotFile> files;
  const auto add = [&](const std::string& study, const std::vector<Plot>& plots) {
    for (const Plot& plot : plots)
      files.push_back({fmt::format("{}_{}.svg", file_name(study), file_name(plot.id)), svg_text(plot, true)});
  };
  for (std::size_t i = 0; i < all.size(); ++i) {
    add(all[i].study, study_plots(all[i], id_of(all, i)));
    for (std::size_t set = 0; set < all[i].sets.size(); ++set) {
      const std::string id = fmt::format("{}set{}_", id_of(all, i), set + 1);
      add(all[i].study, time_plots(all[i].sets[set].figures, id));
      add(all[i].study, metric_plots(all[i].sets[set].figures, id));
      add(all[i].study, correction_plots(all[i].sets[set].figures, id));
    }
  }
  return files;
}

}  // namespace truebearing
