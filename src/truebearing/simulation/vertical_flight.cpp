// SPDX-License-Identifier: Apache-2.0
#include "truebearing/simulation/vertical_flight.hpp"

#include <algorithm>
#include <cmath>

namespace truebearing {

Eigen::Matrix2Xd VerticalFlight::fly(std::span<const double> times_s, double up_m, RandomStream& stream) const {
  constexpr double kMaxSubStep_s = 0.1, kRounding = 1e-9;
  const double most_mps2 = acceleration_mps2.draw(stream);
  double end_s = level_s.draw(stream) * stream.uniform();
  bool climbs = false;
  double wanted_mps = 0.0, rate_mps = 0.0;
  Eigen::Matrix2Xd states(2, static_cast<Eigen::Index>(times_s.size()));
  for (std::size_t k = 0; k < times_s.size(); ++k) {
    states.col(static_cast<Eigen::Index>(k)) << up_m, rate_mps;
    if (k + 1 == times_s.size()) break;
    const double dt_s = times_s[k + 1] - times_s[k];
    const int sub_steps = std::max(1, static_cast<int>(std::ceil(dt_s / kMaxSubStep_s - kRounding)));
    const double h = dt_s / sub_steps;
    for (int i = 0; i < sub_steps; ++i) {
      while (times_s[k] + (i + 0.5) * h >= end_s) {
        climbs = !climbs;
        end_s += (climbs ? climb_s : level_s).draw(stream);
        const double sign = climbs && stream.uniform() < 0.5 ? -1.0 : 1.0;
        wanted_mps = climbs ? sign * climb_mps.draw(stream) : 0.0;
      }
      const double change = std::clamp(wanted_mps - rate_mps, -most_mps2 * h, most_mps2 * h);
      up_m += (rate_mps + 0.5 * change) * h;
      rate_mps += change;
    }
  }
  return states;
}

}  // namespace truebearing
