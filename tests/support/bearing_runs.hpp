// SPDX-License-Identifier: Apache-2.0
// Bearings for tests: windows made from scenarios, and from legs written down.
#pragma once

#include <cmath>
#include <filesystem>
#include <string>

#include "truebearing/core/angle.hpp"
#include "truebearing/core/random.hpp"
#include "truebearing/simulation/scenario.hpp"
#include "truebearing/tma/bearing_window.hpp"

namespace truebearing::testing {

inline std::unique_ptr<Scenario> data_scenario(const std::string& name) {
  return load_scenario(std::filesystem::path(TRUEBEARING_SOURCE_DIR) / "data/scenarios" / (name + ".toml"));
}

/// A scenario whose target turns by 90 degrees at 1000 s, own ship on four legs.
inline const std::string kTurningTarget = R"(
kind = "bearings_only"
period_s = 10
duration_s = 2000
own_ship = { speed_mps = 6, course_deg = 0, turns = [{ time_s = 400, by_deg = 90 }, { time_s = 900, by_deg = -90 },
             { time_s = 1500, by_deg = 90 }] }
target = { range_m = 5000, bearing_deg = 60, course_deg = 300, speed_mps = 5, turns = [{ time_s = 1000, by_deg = 90 }] }
sensor = { bearing_sigma_deg = 0.5 }
)";

/// The bearings of a recording up to `end_s`.
inline BearingWindow window_of(const Recording& recording, double end_s = 1e9) {
  BearingWindow window;
  for (const Measurement& m : recording.measurements)
    if (!m.is_missing() && m.time_s <= end_s) window.add(m.time_s, m.z[0], m.sigma[0], m.sensor->position_m);
  return window;
}

/// The true state at the last measurement not after `end_s`.
inline Eigen::Vector4d truth_at(const Recording& recording, double end_s = 1e9) {
  Eigen::Vector4d x = recording.truth[0].x.front();
  for (std::size_t k = 0; k < recording.measurements.size(); ++k)
    if (recording.measurements[k].time_s <= end_s) x = recording.truth[0].x[k];
  return x;
}

/// Bearings every 10 s to `end_s` from an own ship that sails 5 m/s North, and 5 m/s East from turn_s on, of a target
/// that starts at x0; `noise` in standard deviations of a degree.
inline BearingWindow two_legs(const Eigen::Vector4d& x0, double turn_s, double end_s, double noise = 0.0,
                              std::uint64_t run = 0) {
  constexpr double kSpeed_mps = 5.0, kPeriod_s = 10.0;
  RandomStream stream({1, Role::evaluation, run}, StreamId::test);
  BearingWindow window;
  for (double t = 0.0; t <= end_s; t += kPeriod_s) {
    const Eigen::Vector2d site(kSpeed_mps * std::max(t - turn_s, 0.0), kSpeed_mps * std::min(t, turn_s));
    const Eigen::Vector2d d = x0.head<2>() + t * x0.tail<2>() - site;
    window.add(t, wrap_pi(std::atan2(d.x(), d.y()) + noise * radians(1.0) * stream.normal()), radians(1.0), site);
  }
  return window;
}

}  // namespace truebearing::testing
