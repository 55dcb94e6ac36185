// SPDX-License-Identifier: Apache-2.0
#include "truebearing/simulation/flight_intervals.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "truebearing/core/constants.hpp"

namespace truebearing {
namespace {

struct Interval {
  long holds = 0;
  Eigen::Vector2d acceleration_mps2 = Eigen::Vector2d::Zero();  // along and across
};

// The state [position, velocity] after t seconds at an acceleration.
Eigen::Vector4d after(const Eigen::Vector4d& state, const Eigen::Vector2d& acceleration_mps2, double t) {
  Eigen::Vector4d end;
  end << state.head<2>() + t * state.tail<2>() + 0.5 * t * t * acceleration_mps2,
      state.tail<2>() + t * acceleration_mps2;
  return end;
}

}  // namespace

Eigen::Matrix4Xd FlightIntervals::fly(std::span<const double> times_s, const Eigen::Vector2d& velocity_mps,
                                      RandomStream& stream, double& end_s) const {
  std::vector<Interval> intervals(static_cast<std::size_t>(std::max(1L, std::lround(count.draw(stream)))));
  long all_holds = 0;
  for (Interval& interval : intervals) {
    interval.holds = std::max(1L, std::lround(interval_s.draw(stream) / hold_s));
    interval.acceleration_mps2[0] = along_mps2.draw(stream);
    interval.acceleration_mps2[1] = across_mps2.draw(stream);
    all_holds += interval.holds;
  }
  end_s = static_cast<double>(all_holds) * hold_s;

  Eigen::Matrix4Xd states(4, static_cast<Eigen::Index>(times_s.size()));
  Eigen::Vector4d begin;
  begin << Eigen::Vector2d::Zero(), velocity_mps;
  double begin_s = 0.0;
  std::size_t next = 0;
  const auto fly_until = [&](double until_s, const Eigen::Vector2d& acceleration_mps2) {
    for (; next < times_s.size() && times_s[next] < until_s; ++next)
      states.col(static_cast<Eigen::Index>(next)) = after(begin, acceleration_mps2, times_s[next] - begin_s);
  };
  for (const Interval& interval : intervals)
    for (long hold = 0; hold < interval.holds && next < times_s.size(); ++hold) {
      const Eigen::Vector2d forwards = begin.tail<2>().stableNormalized();
      const Eigen::Vector2d starboard(forwards.y(), -forwards.x());
      const Eigen::Vector2d acceleration_mps2 =
          interval.acceleration_mps2[0] * forwards + interval.acceleration_mps2[1] * starboard;
      fly_until(begin_s + hold_s, acceleration_mps2);
      begin = after(begin, acceleration_mps2, hold_s);
      begin_s += hold_s;
    }
  fly_until(kInfinity, Eigen::Vector2d::Zero());
  return states;
}

}  // namespace truebearing
