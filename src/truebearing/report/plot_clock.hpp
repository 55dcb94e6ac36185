// SPDX-License-Identifier: Apache-2.0
// The clock of a plot. Times of a log may be seconds of an epoch, too long for ticks: they are counted from the first.
#pragma once

#include <fmt/format.h>
#include <string>
#include <vector>

namespace truebearing {

struct PlotClock {
  double zero_s = 0.0;
  std::string label = "time (s)";  ///< of the axis

  explicit PlotClock(const std::vector<double>& time_s) {
    if (time_s.size() < 2 || !(time_s.front() > 10.0 * (time_s.back() - time_s.front()))) return;
    zero_s = time_s.front();
    label = fmt::format("time (s) since {:.15g} s", zero_s);
  }
  std::vector<double> from(std::vector<double> time_s) const {
    for (double& time : time_s) time -= zero_s;
    return time_s;
  }
};

}  // namespace truebearing
