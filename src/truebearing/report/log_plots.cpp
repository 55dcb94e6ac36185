// SPDX-License-Identifier: Apache-2.0
// The plots of what a log says without its truth: the tracks in the plane or over time; of each tracker its innovations and their NIS
// beside where those of a consistent one would be.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "truebearing/report/consistency_plot.hpp"
#include "truebearing/report/log_page.hpp"
#include "truebearing/report/markup.hpp"
#include "truebearing/report/picture_plots.hpp"
#include "truebearing/report/plot_clock.hpp"

namespace truebearing {
namespace {

constexpr std::size_t kMostLogDots = 1500;
constexpr double kOf95 = 1.96;

Look look_in(const LogResults& results, const std::string& name) {
  for (std::size_t i = 0; i < results.trackers.size(); ++i)
    if (results.trackers[i].name == name) return tracker_look(i);
  return {"measured"};
}

// Where the tracker's track was at that time, or last before it.
void add_event(const LogResults& results, const ResultPicture& picture, const LogEvent& event, PlotSeries& marks) {
  for (const ResultTrack& track : results.picture.tracks) {
    if (track.tracker != event.tracker || track.line.time_s.empty() || event.time_s < track.line.time_s.front())
      continue;
    const auto after = std::upper_bound(track.line.time_s.begin(), track.line.time_s.end(), event.time_s);
    const auto at = static_cast<std::size_t>(after - track.line.time_s.begin()) - 1;
    marks.x.push_back(track.line.x.empty() ? event.time_s - picture.clock_zero_s : track.line.x[at]);
    marks.y.push_back(track.line.y[at]);
    marks.time_s.push_back(event.time_s - picture.clock_zero_s);
    return;
  }
}

Plot track_plot(const LogResults& results, const std::string& id) {
  const ResultPicture picture = on_clock(results.picture);
  Plot plot = drawn_picture(picture, [&](const std::string& name) { return look_in(results, name); });
  plot.id = id + "tracks";
  plot.title = "What the trackers made of the log";
  PlotSeries marks{"something noticed", {"event"}, Shape::dots, {}, {}};
  for (const LogEvent& event : results.events) add_event(results, picture, event, marks);
  if (!marks.x.empty()) plot.series.push_back(std::move(marks));
  plot.caption =
      fmt::format("{} are two of each tracker's own standard deviations.{}", picture.in_plane ? "Ellipses" : "Bands",
                  picture.every > 1.0 ? fmt::format(" One step in {:.0f} is drawn.", picture.every) : "");
  for (const LogTracker& tracker : results.trackers)
    for (const LogTracker::Last& last : tracker.last) {
      if (last.estimate.size() < 2) continue;
      plot.summary += fmt::format("{}{} ends at {} {}, {} {}", plot.summary.empty() ? "" : "; ", tracker.name,
                                  last.estimate[0].first, shown(last.estimate[0].second), last.estimate[1].first,
                                  shown(last.estimate[1].second));
    }
  if (!plot.summary.empty()) plot.summary += ".";
  return plot;
}

void add_event_lines(const LogResults& results, const LogTracker& tracker, const PlotClock& clock, Plot& plot,
                     double low, double high) {
  PlotSeries lines{"something noticed", {"event"}, Shape::line, {}, {}};
  for (const LogEvent& event : results.events) {
    if (event.tracker != tracker.name || !std::isfinite(event.time_s)) continue;
    for (const double y : {low, high, kNaN}) {
      lines.x.push_back(event.time_s - clock.zero_s);
      lines.y.push_back(y);
    }
  }
  if (!lines.x.empty()) plot.series.push_back(std::move(lines));
}

// Every n-th of those that were used, or were not.
PlotSeries innovations_of(const LogTracker& tracker, const PlotClock& clock, bool used, const std::string& name,
                          const Look& look) {
  PlotSeries dots{name, look, Shape::dots, {}, {}};
  std::size_t count = 0;
  for (const double one : tracker.used) count += (one != 0.0) == used ? 1u : 0u;
  const std::size_t every = count / (kMostLogDots + 1) + 1;
  std::size_t number = 0;
  for (std::size_t i = 0; i < tracker.time_s.size(); ++i) {
    if ((tracker.used[i] != 0.0) != used || !std::isfinite(tracker.sigmas[i])) continue;
    if (number++ % every != 0) continue;
    dots.x.push_back(tracker.time_s[i] - clock.zero_s);
    dots.y.push_back(tracker.sigmas[i]);
  }
  return dots;
}

Plot innovation_plot(const LogResults& results, std::size_t number, const std::string& id) {
  const LogTracker& tracker = results.trackers[number];
  Plot plot;
  plot.id = fmt::format("{}innovations_{}", id, number);
  plot.title = fmt::format("What {} did not expect", tracker.name);
  plot.y_label = "innovation (standard deviations)";
  if (tracker.time_s.empty()) return plot;
  const PlotClock clock(tracker.time_s);
  plot.x_label = clock.label;
  const std::vector<double> ends = clock.from({tracker.time_s.front(), tracker.time_s.back()});
  plot.series.push_back({"95 %", {"measured"}, Shape::band, ends, {-kOf95, -kOf95}, {kOf95, kOf95}});
  plot.series.push_back({"", {"ideal"}, Shape::line, ends, {0.0, 0.0}});
  plot.series.push_back(innovations_of(tracker, clock, true, "used", tracker_look(0)));
  PlotSeries gated = innovations_of(tracker, clock, false, "not used", tracker_look(1));
  double outside = 0.0, used = 0.0;
  for (std::size_t i = 0; i < tracker.time_s.size(); ++i) {
    if (tracker.used[i] == 0.0 || !std::isfinite(tracker.sigmas[i])) continue;
    used += 1.0;
    outside += std::abs(tracker.sigmas[i]) > kOf95 ? 1.0 : 0.0;
  }
  plot.caption =
      "Measurement minus prediction, first component, in the standard deviations that the tracker claims of it: 19 of 20 "
      "lie in the band where its claim is right.";
  if (used > 0.0)
    plot.summary = fmt::format("Outside: {} % of those that were used.", shown(100.0 * outside / used, 3));
  double low = -kOf95, high = kOf95;
  for (const std::vector<double>* values : {&plot.series.back().y, &gated.y})
    for (const double y : *values) {
      low = std::min(low, y);
      high = std::max(high, y);
    }
  if (!gated.x.empty()) plot.series.push_back(std::move(gated));
  add_event_lines(results, tracker, clock, plot, low, high);
  return plot;
}

Plot nis_plot(const LogResults& results, std::size_t number, const std::string& id) {
  const LogTracker& tracker = results.trackers[number];
  SquaredResiduals used;
  for (std::size_t i = 0; i < tracker.time_s.size(); ++i) {
    if (tracker.used[i] == 0.0) continue;
    used.time_s.push_back(tracker.time_s[i]);
    used.nis.push_back(tracker.nis[i]);
    used.freedom.push_back(tracker.freedom[i]);
  }
  Plot plot = consistency_plot(used, tracker.name);
  plot.id = fmt::format("{}nis_{}", id, number);
  plot.title = fmt::format("Does {} know its error? NIS against time", tracker.name);
  return plot;
}

}  // namespace

std::vector<Plot> log_plots(const LogResults& results, const std::string& id) {
  std::vector<Plot> plots;
  const auto add = [&](Plot plot) {
    if (!plot.empty()) plots.push_back(std::move(plot));
  };
  if (!results.picture.tracks.empty()) add(track_plot(results, id));
  for (std::size_t i = 0; i < results.trackers.size(); ++i) {
    add(nis_plot(results, i, id));
    add(innovation_plot(results, i, id));
  }
  return plots;
}

}  // namespace truebearing
