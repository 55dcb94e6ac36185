// SPDX-License-Identifier: Apache-2.0
// Plots as SVG. Colours are classes of the style sheet; nothing here needs a script, and what is drawn prints.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

#include "truebearing/core/angle.hpp"
#include "truebearing/core/constants.hpp"
#include "truebearing/report/plot_frame.hpp"
#include "truebearing/report/markup.hpp"
#include "truebearing/report/style.hpp"

namespace truebearing {
namespace {

struct Pixel {
  double x, y;
  double time_s = kNaN;  // where the plot can be played
};

double time_of(const PlotSeries& series, std::size_t i) {
  return i < series.time_s.size() ? series.time_s[i] : kNaN;
}

// An attribute with the times of the marks, by which a page plays them (player.hpp).
class MarkTimes {
 public:
  void add(double time_s) {
    if (std::isfinite(time_s)) times_ += fmt::format("{}{:.12g}", times_.empty() ? "" : " ", time_s);
  }
  std::string attribute() const { return times_.empty() ? "" : fmt::format(" data-times=\"{}\"", times_); }

 private:
  std::string times_;
};

std::vector<std::vector<Pixel>> unbroken(const PlotSeries& series, const PlotFrame& frame) {
  std::vector<std::vector<Pixel>> pieces(1);
  for (std::size_t i = 0; i < std::min(series.x.size(), series.y.size()); ++i) {
    const Pixel pixel{frame.x(series.x[i]), frame.y(series.y[i]), time_of(series, i)};
    if (std::isfinite(pixel.x) && std::isfinite(pixel.y))
      pieces.back().push_back(pixel);
    else if (!pieces.back().empty())
      pieces.emplace_back();
  }
  if (pieces.back().empty()) pieces.pop_back();
  return pieces;
}

enum class Keep : unsigned char { both, highest, lowest };

// Of a line with several points in a column of pixels the highest and the lowest look the same, of a band's edge the
// outer one; and the ends. points: of all pieces of a line that is broken, which together are long.
std::vector<Pixel> thinned(const std::vector<Pixel>& line, std::size_t points, Keep keep = Keep::both) {
  if (points < 2 * static_cast<std::size_t>(PlotFrame::kWidth) || line.size() < 3) return line;
  std::vector<Pixel> kept;
  for (std::size_t first = 0, next = 0; first < line.size(); first = next) {
    while (next < line.size() && std::floor(line[next].x) == std::floor(line[first].x)) ++next;
    const auto begin = line.begin() + static_cast<std::ptrdiff_t>(first);
    const auto end = line.begin() + static_cast<std::ptrdiff_t>(next);
    // y points down.
    auto [high, low] = std::minmax_element(begin, end, [](const Pixel& a, const Pixel& b) { return a.y < b.y; });
    std::vector marks{keep == Keep::lowest ? low : high, keep == Keep::highest ? high : low};
    if (first == 0) marks.push_back(begin);
    if (next == line.size()) marks.push_back(end - 1);
    std::sort(marks.begin(), marks.end());
    marks.erase(std::unique(marks.begin(), marks.end()), marks.end());
    for (const auto& mark : marks) kept.push_back(*mark);
  }
  return kept;
}

std::string path_of(const std::vector<Pixel>& line) {
  std::string path;
  for (std::size_t i = 0; i < line.size(); ++i)
    path += fmt::format("{}{:.1f} {:.1f}", i == 0 ? "M" : i == 1 ? "L" : " ", line[i].x, line[i].y);
  return path;
}

std::string draw_line(const PlotSeries& series, const PlotFrame& frame) {
  std::string path;
  MarkTimes times;
  for (const std::vector<Pixel>& piece : unbroken(series, frame)) {
    const std::vector<Pixel> drawn_pixels = thinned(piece, series.x.size());
    path += path_of(drawn_pixels);
    for (const Pixel& pixel : drawn_pixels) times.add(pixel.time_s);
    if (piece.size() == 1) path += "h0";  // a dot, by its round ends
  }
  return path.empty()
             ? ""
             : fmt::format("<path class=\"line {}\" d=\"{}\"{}/>\n", series.look.name, path, times.attribute());
}

std::string draw_dots(const PlotSeries& series, const PlotFrame& frame) {
  std::string path;
  MarkTimes times;
  for (std::size_t i = 0; i < std::min(series.x.size(), series.y.size()); ++i) {
    const double x = frame.x(series.x[i]), y = frame.y(series.y[i]);
    if (!std::isfinite(x) || !std::isfinite(y)) continue;
    path += fmt::format("M{:.1f} {:.1f}h0", x, y);
    times.add(time_of(series, i));
  }
  if (path.empty()) return {};
  return fmt::format("<path class=\"dots {}\" d=\"{}\"{}/>\n", series.look.name, path, times.attribute());
}

// What a logarithmic axis has no place for is below the frame.
std::string draw_band(const PlotSeries& series, const PlotFrame& frame) {
  std::string path;
  std::vector<Pixel> upper, lower;
  const auto close = [&] {
    if (upper.size() > 1) {
      const std::vector<Pixel> there = thinned(upper, series.x.size(), Keep::highest);
      const std::vector<Pixel> back = thinned(lower, series.x.size(), Keep::lowest);
      path += path_of(there);
      for (auto pixel = back.rbegin(); pixel != back.rend(); ++pixel)
        path += fmt::format(" {:.1f} {:.1f}", pixel->x, pixel->y);
      path += "Z";
    }
    upper.clear();
    lower.clear();
  };
  for (std::size_t i = 0; i < std::min({series.x.size(), series.y.size(), series.y2.size()}); ++i) {
    const double x = frame.x(series.x[i]), high = frame.y(series.y2[i]);
    double low = frame.y(series.y[i]);
    if (!std::isfinite(low) && std::isfinite(series.y[i])) low = frame.bottom() + 2.0;
    if (!std::isfinite(x) || !std::isfinite(low) || !std::isfinite(high)) {
      close();
      continue;
    }
    upper.push_back({x, high});
    lower.push_back({x, low});
  }
  close();
  return path.empty() ? "" : fmt::format("<path class=\"band {}\" d=\"{}\"/>\n", series.look.name, path);
}

// Semi-axes are twice the roots of the covariance's eigenvalues; y points down on paper.
std::string draw_ellipses(const PlotSeries& series, const PlotFrame& frame) {
  std::string text;
  const double per_x = frame.width / (frame.x_axis.high - frame.x_axis.low);
  const double per_y = frame.height / (frame.y_axis.high - frame.y_axis.low);
  for (std::size_t i = 0; i < series.x.size(); ++i) {
    const double xx = series.xx[i] * per_x * per_x, yy = series.yy[i] * per_y * per_y;
    const double xy = -series.xy[i] * per_x * per_y;
    const double mean = 0.5 * (xx + yy), spread = std::hypot(0.5 * (xx - yy), xy);
    const double major = 2.0 * std::sqrt(mean + spread), minor = 2.0 * std::sqrt(std::max(0.0, mean - spread));
    const double turn = degrees(0.5 * std::atan2(2.0 * xy, xx - yy));
    const double x = frame.x(series.x[i]), y = frame.y(series.y[i]);
    if (!std::isfinite(major) || !std::isfinite(x) || !std::isfinite(y)) continue;
    MarkTimes times;
    times.add(time_of(series, i));
    text += fmt::format(
        "<ellipse class=\"around {}\" rx=\"{:.1f}\" ry=\"{:.1f}\" transform=\"translate({:.1f} {:.1f}) "
        "rotate({:.1f})\"{}/>\n",
        series.look.name, major, minor, x, y, turn, times.attribute());
  }
  return text;
}

std::string draw_cells(const PlotSeries& series, const PlotFrame& frame) {
  std::string path;
  for (std::size_t i = 0; i < std::min({series.x.size(), series.y.size(), series.x2.size(), series.y2.size()}); ++i) {
    const double left = frame.x(series.x[i]), right = frame.x(series.x2[i]);
    const double bottom = frame.y(series.y[i]), top = frame.y(series.y2[i]);
    if (std::isfinite(left) && std::isfinite(right) && std::isfinite(bottom) && std::isfinite(top))
      path += fmt::format("M{:.1f} {:.1f}H{:.1f}V{:.1f}H{:.1f}z", left, bottom, right, top, left);
  }
  return path.empty() ? "" : fmt::format("<path class=\"cells {}\" d=\"{}\"/>\n", series.look.name, path);
}

std::string draw_sights(const PlotSeries& series, const PlotFrame& frame) {
  std::string path;
  MarkTimes times;
  const double far = std::hypot(frame.width, frame.height);
  for (std::size_t i = 0; i < std::min({series.x.size(), series.y.size(), series.y2.size()}); ++i) {
    const double x = frame.x(series.x[i]), y = frame.y(series.y[i]), bearing = radians(series.y2[i]);
    if (!std::isfinite(x) || !std::isfinite(y) || !std::isfinite(bearing)) continue;
    path += fmt::format("M{:.1f} {:.1f}l{:.1f} {:.1f}", x, y, far * std::sin(bearing), -far * std::cos(bearing));
    times.add(time_of(series, i));
  }
  if (path.empty()) return {};
  return fmt::format("<path class=\"sight {}\" d=\"{}\"{}/>\n", series.look.name, path, times.attribute());
}

std::string draw_series(const PlotSeries& series, const PlotFrame& frame) {
  switch (series.shape) {
    case Shape::line:
      return draw_line(series, frame);
    case Shape::dots:
      return draw_dots(series, frame);
    case Shape::band:
      return draw_band(series, frame);
    case Shape::ellipses:
      return draw_ellipses(series, frame);
    case Shape::cells:
      return draw_cells(series, frame);
    case Shape::sights:
      return draw_sights(series, frame);
  }
  return {};
}

std::string draw_axes(const Plot& plot, const PlotFrame& frame) {
  std::string grid, text;
  for (std::size_t i = 0; i < frame.x_axis.ticks.size(); ++i) {
    const double x = frame.x(frame.x_axis.ticks[i]);
    grid += fmt::format("M{:.1f} {:.1f}V{:.1f}", x, frame.top, frame.bottom());
    text += fmt::format("<text class=\"tick\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>\n", x,
                        frame.bottom() + 17.0, frame.x_axis.labels[i]);
  }
  for (std::size_t i = 0; i < frame.y_axis.ticks.size(); ++i) {
    const double y = frame.y(frame.y_axis.ticks[i]);
    grid += fmt::format("M{:.1f} {:.1f}H{:.1f}", frame.left, y, frame.right());
    text += fmt::format("<text class=\"tick\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>\n",
                        frame.left - 6.0, y + 4.0, frame.y_axis.labels[i]);
  }
  const double middle = frame.top + 0.5 * frame.height;
  text += fmt::format("<text class=\"label\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>\n",
                      frame.left + 0.5 * frame.width, frame.bottom() + 38.0, escaped(plot.x_label));
  text += fmt::format(
      "<text class=\"label\" transform=\"translate(14 {:.1f}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n", middle,
      escaped(plot.y_label));
  return fmt::format("<path class=\"grid\" d=\"{}\"/>\n{}", grid, text);
}

std::string legend_mark(const PlotSeries& series, double x, double y) {
  switch (series.shape) {
    case Shape::line:
      return fmt::format("<path class=\"line {}\" d=\"M{:.1f} {:.1f}h24\"/>", series.look.name, x, y - 4.0);
    case Shape::dots:
      return fmt::format("<path class=\"dots {}\" d=\"M{:.1f} {:.1f}h0\"/>", series.look.name, x + 12.0, y - 4.0);
    case Shape::sights:
      return fmt::format("<path class=\"sight {}\" d=\"M{:.1f} {:.1f}l24 -8\"/>", series.look.name, x, y);
    case Shape::cells:
      return fmt::format("<path class=\"cells {}\" d=\"M{:.1f} {:.1f}h24v-10h-24Z\"/>", series.look.name, x, y + 1.0);
    default:
      return fmt::format("<path class=\"band {}\" d=\"M{:.1f} {:.1f}h24v-10h-24Z\"/>", series.look.name, x, y + 1.0);
  }
}

// Rows of what the marks stand for; `bottom` is where they end.
std::string draw_legend(const Plot& plot, double& bottom) {
  constexpr double kLeft = 8.0, kRow = 19.0, kMark = 30.0, kGap = 16.0;
  std::string text;
  double x = kLeft, y = 16.0;
  for (const PlotSeries& series : plot.series) {
    if (series.name.empty()) continue;
    const double width = kMark + text_width(series.name) + kGap;
    if (x > kLeft && x + width > PlotFrame::kWidth) {
      x = kLeft;
      y += kRow;
    }
    text += fmt::format("{}<text class=\"label\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n", legend_mark(series, x, y),
                        x + kMark, y, escaped(series.name));
    x += width;
  }
  bottom = text.empty() ? 8.0 : y + 12.0;
  return fmt::format("<g class=\"legend\">\n{}</g>\n", text);
}

}  // namespace

Look tracker_look(std::size_t i) {
  constexpr std::size_t kLooks = 8;
  return {fmt::format("s{}", i % kLooks)};
}

bool Plot::empty() const {
  return std::none_of(series.begin(), series.end(), [](const PlotSeries& s) {
    if (s.look.name == "ideal" || s.shape == Shape::band || s.shape == Shape::cells) return false;
    for (std::size_t i = 0; i < std::min(s.x.size(), s.y.size()); ++i)
      if (std::isfinite(s.x[i]) && std::isfinite(s.y[i])) return true;
    return false;
  });
}

std::string svg_text(const Plot& plot, bool standalone) {
  double top = 0.0;
  const std::string legend = draw_legend(plot, top);
  const PlotFrame frame = frame_of(plot, top);
  const std::string id = escaped(plot.id);
  std::string marks;
  for (const PlotSeries& series : plot.series) marks += draw_series(series, frame);
  std::string text = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"plot\" viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" "
      "aria-labelledby=\"{}-title {}-desc\">\n<title id=\"{}-title\">{}</title>\n<desc id=\"{}-desc\">{}</desc>\n",
      PlotFrame::kWidth, std::ceil(frame.bottom() + 46.0), id, id, id, escaped(plot.title), id,
      escaped(plot.summary.empty() ? plot.caption : plot.caption + " " + plot.summary));
  if (standalone) text += fmt::format("<style>{}</style>\n", plot_style());
  text += legend + draw_axes(plot, frame);
  text += fmt::format(
      "<clipPath id=\"{}-frame\"><rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"/></clipPath>\n", id,
      frame.left - 1.0, frame.top - 1.0, frame.width + 2.0, frame.height + 2.0);
  text += fmt::format("<g class=\"marks\" clip-path=\"url(#{}-frame)\">\n{}</g>\n", id, marks);
  text += fmt::format("<path class=\"frame\" d=\"M{:.1f} {:.1f}V{:.1f}H{:.1f}\"/>\n</svg>\n", frame.left, frame.top,
                      frame.bottom(), frame.right());
  return text;
}

}  // namespace truebearing
