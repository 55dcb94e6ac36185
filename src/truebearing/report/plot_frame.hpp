// SPDX-License-Identifier: Apache-2.0
// Where on the paper the values of a plot stand: its axes, and the rectangle between them in pixels.
#pragma once

#include "truebearing/report/axis.hpp"
#include "truebearing/report/plot.hpp"

namespace truebearing {

/// Lengths in pixels of the drawing, y downwards.
struct PlotFrame {
  static constexpr double kWidth = 560.0;
  Axis x_axis, y_axis;
  double left = 0.0, top = 0.0, width = 0.0, height = 0.0;

  double x(double value) const { return left + width * x_axis.place(value); }
  double y(double value) const { return top + height * (1.0 - y_axis.place(value)); }
  double right() const { return left + width; }
  double bottom() const { return top + height; }
};

/// The frame of a plot that is not empty, below `top`.
PlotFrame frame_of(const Plot& plot, double top);

/// How wide a text of the drawing is, about.
double text_width(const std::string& text);

}  // namespace truebearing
