// SPDX-License-Identifier: Apache-2.0
// An axis of a plot: its range, its ticks at round numbers, and where on it a value stands.
#pragma once

#include <string>
#include <vector>

namespace truebearing {

struct Axis {
  double low = 0.0, high = 1.0;
  bool logarithmic = false;
  std::vector<double> ticks;        ///< ascending, within [low, high]
  std::vector<std::string> labels;  ///< of each tick

  /// 0 at low, 1 at high. NaN of what has no place there.
  double place(double value) const;
};

/// Over [low, high], widened to whole steps of 1, 2 or 5 times a power of ten, about `about` of them. A range of
/// nothing is widened about its value.
Axis linear_axis(double low, double high, int about);
/// The same range without widening it: for axes of equal scale.
Axis exact_axis(double low, double high, int about);
/// Over [low, high], 0 < low: ticks at powers of ten, at 1, 2 and 5 times them where there are few.
Axis logarithmic_axis(double low, double high);

/// Do positive values span so much that small ones would be lost on a linear axis? More than a factor of 30, the
/// middle, on a logarithmic scale, of the tenth and the hundredth of a plot's height.
bool wants_logarithm(const std::vector<double>& values);

}  // namespace truebearing
