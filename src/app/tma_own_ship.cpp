// SPDX-License-Identifier: Apache-2.0
#include "app/tma_own_ship.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <vector>

#include "truebearing/evaluation/statistics.hpp"

namespace truebearing {
namespace {

// From one bearing to a later one: how far own ship went by its positions, and how far by its velocity.
struct OwnShipStep {
  Eigen::Vector2d went_m, sailed_m;
  double time_s;
  std::size_t to;  // that bearing
  double off_m() const { return (went_m - sailed_m).norm(); }
};

std::vector<OwnShipStep> steps_of(const TmaWindows& windows) {
  std::vector<OwnShipStep> steps;
  for (std::size_t i = 1; i < windows.own_ship.size(); ++i) {
    const SensorState &from = windows.own_ship[i - 1], &to = windows.own_ship[i];
    const double time_s = windows.bearings.time_s(i) - windows.bearings.time_s(i - 1);
    steps.push_back({to.position_m - from.position_m, 0.5 * time_s * (from.velocity_mps + to.velocity_mps), time_s, i});
  }
  return steps;
}

// What a factor between positions and velocities comes from.
std::string unit_behind(double factor) {
  struct Unit {
    double factor;
    const char* says;
  };
  for (const Unit& unit :
       {Unit{1e-3, "are the positions in kilometres?"}, Unit{1.0 / 1852.0, "are the positions in nautical miles?"},
        Unit{1.0 / 0.3048, "are the positions in feet?"}, Unit{1852.0 / 3600.0, "is the velocity in knots?"},
        Unit{1.0 / 3.6, "is the velocity in km/h?"}, Unit{1e3, "is the velocity in km/s, or are the positions in mm?"}})
    if (std::abs(factor / unit.factor - 1.0) < 0.06) return unit.says;
  return "is one of them in another unit?";
}

// All the way: positions are some multiple of what they should be, and nothing else is wrong with them.
std::string factor_of(const std::vector<OwnShipStep>& steps) {
  constexpr double kGross = 1.67, kUnexplained = 0.04;
  double both = 0.0, sailed = 0.0, went = 0.0;
  for (const OwnShipStep& step : steps) {
    both += step.went_m.dot(step.sailed_m);
    sailed += step.sailed_m.squaredNorm();
    went += step.went_m.squaredNorm();
  }
  const double factor = both / sailed;
  if (!(factor > 0.0) || (factor < kGross && factor > 1.0 / kGross)) return {};
  if (went - both * factor > kUnexplained * went) return {};
  return fmt::format(
      "own ship's positions (sensor_east_m, sensor_north_m) change {:.3g} times as fast as its velocity "
      "(sensor_east_mps, sensor_north_mps) says: {}",
      factor, unit_behind(factor));
}

// At a few places: farther than own ship can have sailed, and than its positions are uncertain.
std::string jump_of(const std::vector<OwnShipStep>& steps, const TmaWindows& windows) {
  constexpr double kTimesAsFast = 5.0, kOfUsual = 20.0, kLeast_m = 1.0, kMostOfAll = 0.1;
  std::vector<double> off_m;
  double fastest_mps = 0.0;
  for (const OwnShipStep& step : steps) off_m.push_back(step.off_m());
  for (const SensorState& own_ship : windows.own_ship)
    fastest_mps = std::max(fastest_mps, own_ship.velocity_mps.norm());
  const double usual_m = median_of(off_m);
  std::vector<const OwnShipStep*> jumps;
  for (const OwnShipStep& step : steps)
    if (step.off_m() > std::max({kTimesAsFast * fastest_mps * step.time_s, kOfUsual * usual_m, kLeast_m}))
      jumps.push_back(&step);
  if (jumps.empty() || static_cast<double>(jumps.size()) > kMostOfAll * static_cast<double>(steps.size())) return {};
  const OwnShipStep& worst = **std::max_element(jumps.begin(), jumps.end(),
                                                [](const auto* a, const auto* b) { return a->off_m() < b->off_m(); });
  return fmt::format(
      "own ship's position jumps by {:.0f} m between {} s (line {}) and {} s (line {}){}, where its velocity makes "
      "{:.0f} m",
      worst.went_m.norm(), seconds(windows.bearings.time_s(worst.to - 1)), windows.line[worst.to - 1],
      seconds(windows.bearings.time_s(worst.to)), windows.line[worst.to],
      jumps.size() > 1 ? fmt::format(" and at {} more times", jumps.size() - 1) : "", worst.sailed_m.norm());
}

}  // namespace

std::string own_ship_is_off(const TmaWindows& windows) {
  const bool has_velocity = std::any_of(windows.own_ship.begin(), windows.own_ship.end(),
                                        [](const auto& own_ship) { return !own_ship.velocity_mps.isZero(0.0); });
  if (!has_velocity) return {};
  const std::vector<OwnShipStep> steps = steps_of(windows);
  const std::string jump = jump_of(steps, windows);
  return jump.empty() ? factor_of(steps) : jump;
}

}  // namespace truebearing
