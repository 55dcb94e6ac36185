// SPDX-License-Identifier: Apache-2.0
// A plot before it is drawn: what is in it, in the units of its axes. And its drawing as SVG (svg.cpp), its numbers as a
// table (plot_table.cpp).
#pragma once

#include <string>
#include <vector>

namespace truebearing {

/// Who or what a mark stands for: colours and dashes are the style sheet's (style.hpp).
struct Look {
  std::string name;  ///< a class: "s0" ... "s7" of trackers, "truth", "bound", "measured", "own", "ideal",
                     ///< "other", "event", "seen", "level1" ... "level5"
};
/// Of the i-th tracker of a study.
Look tracker_look(std::size_t i);

enum class Shape : unsigned char {
  line,      ///< through (x, y); NaN breaks it
  dots,      ///< a dot at each (x, y)
  band,      ///< between y and y2 over x
  ellipses,  ///< of two standard deviations about (x, y), covariance (xx, xy, yy)
  cells,     ///< rectangles from (x, y) to (x2, y2)
  sights     ///< from (x, y) along the bearing y2, degrees clockwise from upwards, to the edge
};

struct PlotSeries {
  std::string name;  ///< in the legend; empty: not there
  Look look;
  Shape shape = Shape::line;
  std::vector<double> x, y;
  std::vector<double> y2 = {};
  std::vector<double> xx = {}, xy = {}, yy = {};
  std::vector<double> time_s = {};  ///< of each mark, where the plot can be played
  std::vector<double> x2 = {};      ///< of cells
};

struct Plot {
  std::string id;       ///< unique on its page, and a file's name: "error_position_m"
  std::string title;    ///< "Position error against time"
  std::string caption;  ///< a sentence or two of what is drawn
  std::string summary;  ///< what is to be seen, in figures: with the caption the text alternative
  std::string x_label, y_label;
  bool x_logarithmic = false, y_logarithmic = false;
  bool equal = false;  ///< one scale for both axes, as a plane asks
  std::vector<PlotSeries> series;

  /// Is there anything to draw?
  bool empty() const;
};

/// The plot as an SVG element. standalone: as a file of its own, with its style sheet.
std::string svg_text(const Plot& plot, bool standalone = false);

/// Its numbers as HTML tables, one for the series that share x; of many rows every n-th. Ellipses and cells are left out.
std::string number_tables(const Plot& plot);

}  // namespace truebearing
