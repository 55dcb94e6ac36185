// SPDX-License-Identifier: Apache-2.0
#include "truebearing/report/consistency_plot.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <utility>

#include "truebearing/core/chi_square.hpp"
#include "truebearing/report/axis.hpp"
#include "truebearing/report/plot_clock.hpp"

namespace truebearing {

Plot consistency_plot(const SquaredResiduals& residuals, const std::string& name) {
  constexpr std::size_t kLeastWindow = 5, kWindows = 40;
  constexpr double kMostFreedom = 1e6;
  Plot plot;
  std::vector<std::size_t> told;
  for (std::size_t i = 0; i < std::min(residuals.time_s.size(), residuals.nis.size()); ++i)
    if (residuals.freedom[i] >= 1.0 && residuals.freedom[i] <= kMostFreedom && std::isfinite(residuals.nis[i]))
      told.push_back(i);
  const std::size_t window = std::max(kLeastWindow, told.size() / kWindows);
  if (told.size() < 2 * window) return plot;
  const PlotClock clock(residuals.time_s);
  PlotSeries band{"95 % where claims are right", {"measured"}, Shape::band, {}, {}, {}};
  PlotSeries line{name, tracker_look(0), Shape::line, {}, {}};
  std::size_t inside = 0;
  for (std::size_t first = 0; first + window <= told.size(); first += window) {
    double nis = 0.0, freedom = 0.0, time_s = 0.0;
    for (std::size_t i = first; i < first + window; ++i) {
      nis += residuals.nis[told[i]];
      freedom += residuals.freedom[told[i]];
      time_s += (residuals.time_s[told[i]] - clock.zero_s) / static_cast<double>(window);
    }
    const ChiSquareMeans consistent = chi_square_means(freedom, 1.0);
    band.x.push_back(time_s);
    band.y.push_back(consistent.low);
    band.y2.push_back(consistent.high);
    line.x.push_back(time_s);
    line.y.push_back(nis / freedom);
    if (line.y.back() >= consistent.low && line.y.back() <= consistent.high) ++inside;
  }
  plot.x_label = clock.label;
  plot.y_label = "mean NIS, 1 expected";
  plot.caption = fmt::format(
      "Squared residuals in units of what is claimed of them, by their degrees of freedom; means over {}. Above the band more is claimed to be known than "
      "is, below it less.",
      window);
  plot.summary = fmt::format("{} of {} means are inside.", inside, line.x.size());
  plot.y_logarithmic = wants_logarithm(line.y);
  PlotSeries one{"", {"ideal"}, Shape::line, {line.x.front(), line.x.back()}, {1.0, 1.0}};
  plot.series = {std::move(band), std::move(one), std::move(line)};
  return plot;
}

}  // namespace truebearing
