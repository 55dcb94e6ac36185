// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/time_steps.hpp"

#include <algorithm>

namespace truebearing {

std::vector<int> steps_at(const Recording& recording, const std::vector<double>& times_s) {
  if (times_s.empty()) return {};
  constexpr double kRounding_s = 1e-6;
  const std::vector<Measurement>& measurements = recording.measurements;
  double longest_s = 0.0;
  for (std::size_t k = 1; k < measurements.size(); ++k)
    longest_s = std::max(longest_s, measurements[k].time_s - measurements[k - 1].time_s);
  std::vector<int> steps;
  for (const double time_s : times_s) {
    const auto after =
        std::upper_bound(measurements.begin(), measurements.end(), time_s + kRounding_s,
                         [](double time, const Measurement& measurement) { return time < measurement.time_s; });
    int step = static_cast<int>(after - measurements.begin()) - 1;
    const bool reached = step >= 0 && time_s <= measurements.back().time_s + longest_s + kRounding_s;
    if (!reached || !recording.truth.front().x[static_cast<std::size_t>(step)].allFinite()) step = -1;
    steps.push_back(step);
  }
  return steps;
}

}  // namespace truebearing
