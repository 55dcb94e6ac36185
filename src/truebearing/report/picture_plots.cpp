// SPDX-License-Identifier: Apache-2.0
// One run as it happened: in the plane with bearing lines and ellipses, or a value over time.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "truebearing/evaluation/metric.hpp"
#include "truebearing/report/axis.hpp"
#include "truebearing/report/markup.hpp"
#include "truebearing/report/picture_plots.hpp"
#include "truebearing/report/plot_clock.hpp"
#include "truebearing/report/study_plots.hpp"

namespace truebearing {
namespace {

// Ellipses and bearings beyond a dozen or two cover each other.
constexpr std::size_t kMostEllipses = 12, kMostSights = 30;

PlotSeries drawn(const std::string& name, const Look& look, Shape shape, const ResultLine& line) {
  PlotSeries series{name, look, shape, line.x.empty() ? line.time_s : line.x, line.y};
  series.time_s = line.time_s;
  return series;
}

bool stands_still(const ResultLine& line) {
  const auto is_same = [](const std::vector<double>& values) {
    return std::all_of(values.begin(), values.end(), [&](double value) { return value == values.front(); });
  };
  return is_same(line.x) && is_same(line.y);
}

// Neighbours in time of one shade are one rectangle: an angle's row mostly holds few.
void add_beam(const ResultPicture& picture, Plot& plot) {
  constexpr double kShade = 3.0;
  constexpr int kShades = 5;
  const std::vector<double>&time_s = picture.beam_time_s, &angle_deg = picture.beam_angle_deg;
  if (time_s.size() < 2 || angle_deg.size() < 2) return;
  const double half = 0.5 * (angle_deg[1] - angle_deg[0]);
  const auto begins_at = [&](std::size_t i) {
    if (i == 0) return time_s[0];
    return i < time_s.size() ? 0.5 * (time_s[i - 1] + time_s[i]) : time_s.back();
  };
  std::vector<PlotSeries> shades;
  for (int shade = 0; shade < kShades; ++shade)
    shades.push_back({shade == 0 ? "beam's power, in steps of 3 dB" : "",
                      {fmt::format("level{}", shade + 1)},
                      Shape::cells,
                      {},
                      {}});
  const auto shade_of = [&](std::size_t i, std::size_t angle) {
    const double below_dB = picture.below_dB[i][angle];
    return below_dB >= 0.0 && below_dB < kShade * kShades ? static_cast<int>(below_dB / kShade) : -1;
  };
  for (std::size_t angle = 0; angle < angle_deg.size(); ++angle)
    for (std::size_t first = 0, next = 0; first < time_s.size(); first = next) {
      while (next < time_s.size() && shade_of(next, angle) == shade_of(first, angle)) ++next;
      if (shade_of(first, angle) < 0) continue;
      PlotSeries& cells = shades[static_cast<std::size_t>(shade_of(first, angle))];
      cells.x.push_back(begins_at(first));
      cells.x2.push_back(begins_at(next));
      cells.y.push_back(angle_deg[angle] - half);
      cells.y2.push_back(angle_deg[angle] + half);
    }
  for (PlotSeries& cells : shades)
    if (!cells.x.empty()) plot.series.push_back(std::move(cells));
}

void add_own_ship(const ResultPicture& picture, Plot& plot) {
  if (picture.own_ship.y.empty()) return;
  PlotSeries sights = drawn("bearing", {"measured"}, Shape::sights, picture.own_ship);
  const std::size_t every = sights.x.size() / (kMostSights + 1) + 1;
  PlotSeries few{sights.name, sights.look, Shape::sights, {}, {}, {}};
  for (std::size_t i = 0; i < std::min(sights.x.size(), picture.bearing_deg.size()); i += every) {
    few.x.push_back(sights.x[i]);
    few.y.push_back(sights.y[i]);
    few.y2.push_back(picture.bearing_deg[i]);
    few.time_s.push_back(sights.time_s[i]);
  }
  plot.series.push_back(std::move(few));
  const bool still = stands_still(picture.own_ship);
  plot.series.push_back(drawn("own ship", {"own"}, still ? Shape::dots : Shape::line, picture.own_ship));
  if (!still) return;
  plot.series.back().x.resize(1);
  plot.series.back().y.resize(1);
  plot.series.back().time_s.clear();
}

void add_uncertainty(const ResultTrack& track, const Look& look, Plot& plot) {
  const ResultLine& line = track.line;
  if (line.x.empty()) {
    PlotSeries band{"", look, Shape::band, line.time_s, line.y, line.y};
    for (std::size_t i = 0; i < line.y.size(); ++i) {
      band.y[i] -= 2.0 * std::sqrt(track.yy[i]);
      band.y2[i] += 2.0 * std::sqrt(track.yy[i]);
    }
    plot.series.push_back(std::move(band));
    return;
  }
  PlotSeries ellipses{"", look, Shape::ellipses, {}, {}, {}, {}, {}, {}};
  const std::size_t every = line.x.size() / (kMostEllipses + 1) + 1;
  for (std::size_t i = every - 1; i < line.x.size(); i += every) {
    ellipses.x.push_back(line.x[i]);
    ellipses.y.push_back(line.y[i]);
    ellipses.xx.push_back(track.xx[i]);
    ellipses.xy.push_back(track.xy[i]);
    ellipses.yy.push_back(track.yy[i]);
    ellipses.time_s.push_back(line.time_s[i]);
  }
  plot.series.push_back(std::move(ellipses));
}

}  // namespace

ResultPicture on_clock(ResultPicture picture) {
  const auto each_line = [&](const auto& take) {
    for (ResultLine& truth : picture.truth) take(truth);
    take(picture.measured);
    take(picture.own_ship);
    for (ResultTrack& track : picture.tracks) take(track.line);
  };
  double first = kInfinity, last = -kInfinity;
  each_line([&](const ResultLine& line) {
    for (const double time_s : line.time_s) {
      first = std::min(first, time_s);
      last = std::max(last, time_s);
    }
  });
  if (!(first < last)) return picture;
  const PlotClock clock({first, last});
  picture.clock_zero_s = clock.zero_s;
  picture.clock_label = clock.label;
  each_line([&](ResultLine& line) { line.time_s = clock.from(std::move(line.time_s)); });
  picture.beam_time_s = clock.from(std::move(picture.beam_time_s));
  return picture;
}

Plot drawn_picture(const ResultPicture& picture, const std::function<Look(const std::string&)>& look_of_tracker) {
  Plot plot;
  plot.equal = picture.in_plane;
  plot.x_label = picture.in_plane ? "East (m)" : picture.clock_label;
  plot.y_label = picture.in_plane ? "North (m)" : axis_name(picture.component);
  if (!picture.in_plane) add_beam(picture, plot);
  add_own_ship(picture, plot);
  if (!picture.measured.y.empty())
    plot.series.push_back(drawn("measured", {"measured"}, Shape::dots, picture.measured));
  for (const ResultTrack& track : picture.tracks) add_uncertainty(track, look_of_tracker(track.tracker), plot);
  for (std::size_t i = 0; i < picture.truth.size(); ++i)
    plot.series.push_back(drawn(i == 0 ? "truth" : "", {"truth"}, Shape::line, picture.truth[i]));
  std::vector<std::string> named;
  for (const ResultTrack& track : picture.tracks) {
    const bool again = std::find(named.begin(), named.end(), track.tracker) != named.end();
    plot.series.push_back(drawn(again ? "" : track.tracker, look_of_tracker(track.tracker), Shape::line, track.line));
    named.push_back(track.tracker);
  }
  return plot;
}

namespace {

Plot picture_plot(const Results& results, const ResultPicture& picture, const std::string& id) {
  Plot plot = drawn_picture(picture, [&](const std::string& name) { return look_of(results.all, name); });
  plot.id = fmt::format("{}run_{}", id, picture.which);
  plot.title = fmt::format("{} run of {}", capitalised(picture.which), picture.judged_by);
  const std::string of_set = picture.set.empty() ? "" : fmt::format(" of {}", picture.set);
  plot.caption = fmt::format(
      "Run {:.0f}{}, in which the {} RMSE of {} is {} {}. {} are two of the tracker's own standard deviations.{}",
      picture.run, of_set, name_of(picture.quantity), picture.judged_by, shown(picture.rmse), unit_of(picture.quantity),
      picture.in_plane ? "Ellipses" : "Bands",
      picture.every > 1.0 ? fmt::format(" One step in {:.0f} is drawn.", picture.every) : "");
  return plot;
}

// From the target that is nearest at each time, where tracks belong to targets by where they are; none within reach: none.
PlotSeries error_of_nearest(const std::vector<ResultLine>& targets, double within, const ResultTrack& track,
                            const std::string& name, const Look& look) {
  PlotSeries line{name, look, Shape::line, {}, {}};
  for (std::size_t i = 0; i < track.line.y.size(); ++i) {
    double least = kNaN;
    for (const ResultLine& truth : targets) {
      const auto at = std::lower_bound(truth.time_s.begin(), truth.time_s.end(), track.line.time_s[i]);
      if (at == truth.time_s.end() || *at != track.line.time_s[i]) continue;
      const auto step = static_cast<std::size_t>(at - truth.time_s.begin());
      const double dy = track.line.y[i] - truth.y[step];
      const double error = truth.x.empty() ? dy : std::hypot(track.line.x[i] - truth.x[step], dy);
      if (std::abs(error) <= within && !(std::abs(error) >= std::abs(least))) least = error;
    }
    line.x.push_back(track.line.time_s[i]);
    line.y.push_back(least);
  }
  return line;
}

// At the times that both have: the distance in the plane, else the difference.
PlotSeries error_of(const ResultLine& truth, const ResultTrack& track, const std::string& name, const Look& look) {
  PlotSeries line{name, look, Shape::line, {}, {}};
  std::size_t step = 0;
  for (std::size_t i = 0; i < track.line.y.size(); ++i) {
    while (step < truth.time_s.size() && truth.time_s[step] < track.line.time_s[i]) ++step;
    if (step == truth.time_s.size() || truth.time_s[step] != track.line.time_s[i]) continue;
    const double dy = track.line.y[i] - truth.y[step];
    line.x.push_back(track.line.time_s[i]);
    line.y.push_back(truth.x.empty() ? dy : std::hypot(track.line.x[i] - truth.x[step], dy));
  }
  return line;
}

// What lies too close together in the picture itself. A picture of one target is of one track, whatever it is called.
Plot picture_error_plot(const Results& results, const ResultPicture& picture, const std::string& id) {
  Plot plot;
  plot.id = fmt::format("{}run_{}_error", id, picture.which);
  plot.title = fmt::format("Its error against time: {} run", picture.which);
  plot.x_label = picture.clock_label;
  plot.y_label = picture.in_plane
                     ? "distance from the truth (m)"
                     : fmt::format("{} − truth ({})", name_of(picture.component), unit_of(picture.component));
  plot.caption =
      picture.in_plane ? "How far each track is from the truth." : "By how much each track is above the truth.";
  if (std::isfinite(picture.assigned_within))
    plot.caption +=
        fmt::format(" Of several targets, from the nearest at each time; one that has none within {} {} is left out.",
                    shown(picture.assigned_within), unit_of(picture.component));
  std::vector<std::string> named;
  std::vector<double> errors;
  for (const ResultTrack& track : picture.tracks)
    for (const ResultLine& truth : picture.truth) {
      const bool nearest = std::isfinite(picture.assigned_within) && picture.truth.size() > 1;
      if (nearest ? &truth != &picture.truth.front() : picture.truth.size() > 1 && truth.track != track.line.track)
        continue;
      const bool again = std::find(named.begin(), named.end(), track.tracker) != named.end();
      const std::string name = again ? "" : track.tracker;
      const Look look = look_of(results.all, track.tracker);
      plot.series.push_back(nearest ? error_of_nearest(picture.truth, picture.assigned_within, track, name, look)
                                    : error_of(truth, track, name, look));
      named.push_back(track.tracker);
      errors.insert(errors.end(), plot.series.back().y.begin(), plot.series.back().y.end());
    }
  plot.y_logarithmic = picture.in_plane && wants_logarithm(errors);
  return plot;
}

}  // namespace

std::vector<Plot> picture_plots(const Results& results, const std::string& id) {
  std::vector<Plot> plots;
  for (const ResultPicture& timed : results.pictures) {
    const ResultPicture picture = on_clock(timed);
    for (Plot plot : {picture_plot(results, picture, id), picture_error_plot(results, picture, id)})
      if (!plot.empty()) plots.push_back(std::move(plot));
  }
  return plots;
}

}  // namespace truebearing
