// SPDX-License-Identifier: Apache-2.0
#include "truebearing/report/plot_frame.hpp"

#include <algorithm>
#include <cmath>

#include "truebearing/core/constants.hpp"

namespace truebearing {
namespace {

constexpr double kCharacter = 7.6;  // of a wide sans-serif at 13 pixels

struct Extent {
  double low = kInfinity, high = -kInfinity;
  void take(double value, bool logarithmic) {
    if (!std::isfinite(value) || (logarithmic && value <= 0.0)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  bool is_empty() const { return low > high; }
};

// Bands and ellipses may leave the frame where what they are about does not: a band of errors reaches down to nothing.
void take_series(const Plot& plot, Extent& x, Extent& y) {
  for (const PlotSeries& series : plot.series) {
    if (series.shape == Shape::ellipses || series.shape == Shape::cells) continue;
    for (const double value : series.x) x.take(value, plot.x_logarithmic);
    for (const double value : series.y) y.take(value, plot.y_logarithmic);
    if (series.shape == Shape::band && !plot.y_logarithmic)
      for (const double value : series.y2) y.take(value, false);
  }
}

// Of a picture with a truth: tracks count up to as far beside truth and sensor as those reach. One that is lost leaves the
// frame, and the others stay to be seen.
void keep_near_truth(const Plot& plot, Extent& x, Extent& y) {
  Extent core_x, core_y;
  bool has_truth = false;
  for (const PlotSeries& series : plot.series) {
    if (series.look.name != "truth" && series.look.name != "own") continue;
    has_truth |= series.look.name == "truth";
    for (const double value : series.x) core_x.take(value, false);
    for (const double value : series.y) core_y.take(value, false);
  }
  if (!has_truth || core_x.is_empty() || core_y.is_empty()) return;
  const double reach = std::max(core_x.high - core_x.low, core_y.high - core_y.low);
  const auto cut = [](Extent& extent, const Extent& core, double beside) {
    extent.low = std::max(extent.low, core.low - beside);
    extent.high = std::min(extent.high, core.high + beside);
  };
  cut(y, core_y, plot.equal ? reach : core_y.high - core_y.low);
  if (plot.equal) cut(x, core_x, reach);
}

// Ellipses in the plane that are not larger than what they are about.
void take_ellipses(const Plot& plot, Extent& x, Extent& y) {
  const double reach = 0.5 * std::max(x.high - x.low, y.high - y.low);
  const Extent core_x = x, core_y = y;
  for (const PlotSeries& series : plot.series)
    for (std::size_t i = 0; i < series.xx.size(); ++i) {
      const double half_x = 2.0 * std::sqrt(series.xx[i]), half_y = 2.0 * std::sqrt(series.yy[i]);
      const bool inside = series.x[i] >= core_x.low && series.x[i] <= core_x.high && series.y[i] >= core_y.low &&
                          series.y[i] <= core_y.high;
      if (!inside || !(std::max(half_x, half_y) < reach)) continue;
      for (const double side : {-1.0, 1.0}) {
        x.take(series.x[i] + side * half_x, false);
        y.take(series.y[i] + side * half_y, false);
      }
    }
}

// A few values that have run away by many decades would press all others together: a logarithmic axis ends three
// decades from the median, where a factor of two can still be seen. Lines leave the frame there.
void keep_near_median(std::vector<double> values, Extent& extent) {
  std::erase_if(values, [](double value) { return !std::isfinite(value) || value <= 0.0; });
  if (values.empty()) return;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  constexpr double kDecades = 1e3;
  extent.low = std::max(extent.low, *middle / kDecades);
  extent.high = std::min(extent.high, *middle * kDecades);
}

std::vector<double> values_of(const Plot& plot, const std::vector<double> PlotSeries::*column) {
  std::vector<double> values;
  for (const PlotSeries& series : plot.series)
    if (series.shape != Shape::band) values.insert(values.end(), (series.*column).begin(), (series.*column).end());
  return values;
}

// Errors and shares are read from nothing upwards where that wastes less than half of the plot.
Axis axis_of(Extent extent, bool logarithmic, bool from_zero, int about) {
  if (extent.is_empty()) extent = {0.0, 1.0};
  if (logarithmic) {
    const double margin = std::pow(extent.high / extent.low, 0.03);
    return logarithmic_axis(extent.low / margin, extent.high * margin);
  }
  if (from_zero && extent.low == 0.0 && extent.high == 0.0) extent.high = 1.0;
  if (from_zero && extent.low > 0.0 && extent.low < 0.5 * extent.high) extent.low = 0.0;
  return linear_axis(extent.low, extent.high, about);
}

// Both axes at one scale: the looser one is widened about its middle.
void make_equal(PlotFrame& frame, const Extent& x, const Extent& y) {
  constexpr double kMargin = 1.06;
  double per_pixel = kMargin * std::max((x.high - x.low) / frame.width, (y.high - y.low) / frame.height);
  if (!(per_pixel > 0.0)) per_pixel = 1.0 / frame.width;
  const auto about = [&](const Extent& extent, double pixels, int ticks) {
    const double middle = 0.5 * (extent.low + extent.high), half = 0.5 * per_pixel * pixels;
    return exact_axis(middle - half, middle + half, ticks);
  };
  frame.x_axis = about(x, frame.width, 6);
  frame.y_axis = about(y, frame.height, 6);
}

double widest(const std::vector<std::string>& labels) {
  double width = 0.0;
  for (const std::string& label : labels) width = std::max(width, text_width(label));
  return width;
}

}  // namespace

double text_width(const std::string& text) {
  const auto characters = std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0u) != 0x80u;  // continued bytes of UTF-8 aside
  });
  return kCharacter * static_cast<double>(characters);
}

PlotFrame frame_of(const Plot& plot, double top) {
  constexpr double kLabel = 26.0, kRight = 16.0, kHeight = 270.0, kSquare = 430.0;
  Extent x, y;
  take_series(plot, x, y);
  keep_near_truth(plot, x, y);
  if (plot.equal) take_ellipses(plot, x, y);
  if (plot.x_logarithmic && !plot.equal) keep_near_median(values_of(plot, &PlotSeries::x), x);
  if (plot.y_logarithmic && !plot.equal) keep_near_median(values_of(plot, &PlotSeries::y), y);
  PlotFrame frame;
  frame.top = top;
  frame.height = plot.equal ? kSquare : kHeight;
  frame.x_axis = axis_of(x, plot.x_logarithmic, false, 6);
  frame.y_axis = axis_of(y, plot.y_logarithmic, !plot.equal, 5);
  const auto fit = [&] {
    frame.left = kLabel + widest(frame.y_axis.labels) + 8.0;
    frame.width = PlotFrame::kWidth - kRight - frame.left;
  };
  fit();
  if (!plot.equal) {
    // Time and the like go to the edges.
    if (!plot.x_logarithmic && !x.is_empty() && x.high > x.low) frame.x_axis = exact_axis(x.low, x.high, 6);
    return frame;
  }
  if (plot.x_logarithmic || plot.y_logarithmic) {  // of equal scale where both have the same range
    const Extent both{std::min(x.low, y.low), std::max(x.high, y.high)};
    frame.x_axis = frame.y_axis = axis_of(both, true, false, 5);
    fit();
    frame.height = frame.width;
    return frame;
  }
  make_equal(frame, x, y);
  fit();
  make_equal(frame, x, y);
  return frame;
}

}  // namespace truebearing
