// SPDX-License-Identifier: Apache-2.0
#include "truebearing/simulation/angle_path.hpp"

#include <algorithm>
#include <cmath>

#include "truebearing/core/angle.hpp"

namespace truebearing {

double AnglePath::angle_rad(double time_s) const {
  double angle = start_rad + rate_radps * time_s;
  for (const Sine& sine : sines)
    angle += sine.amplitude_rad * std::sin(2.0 * kPi * std::min(time_s, sine.until_s) / sine.period_s);
  for (const Bend& bend : bends) angle += bend.height_rad * std::tanh((time_s - bend.centre_s) / bend.width_s);
  for (const Hyperbola& hyperbola : hyperbolas)
    angle += std::hypot(hyperbola.rate_radps * (time_s - hyperbola.centre_s), hyperbola.closest_rad);
  return angle;
}

double AnglePath::rate_at_radps(double time_s) const {
  double rate = rate_radps;
  for (const Sine& sine : sines)
    if (time_s < sine.until_s)
      rate += sine.amplitude_rad * 2.0 * kPi / sine.period_s * std::cos(2.0 * kPi * time_s / sine.period_s);
  for (const Bend& bend : bends) {
    const double slope = 1.0 / std::cosh((time_s - bend.centre_s) / bend.width_s);
    rate += bend.height_rad / bend.width_s * slope * slope;
  }
  for (const Hyperbola& hyperbola : hyperbolas) {
    const double along = hyperbola.rate_radps * (time_s - hyperbola.centre_s);
    rate += hyperbola.rate_radps * along / std::hypot(along, hyperbola.closest_rad);
  }
  return rate;
}

AnglePath read_angle_path(TableReader& table) {
  constexpr Range kAngle{-90.0, 90.0};
  AnglePath path;
  path.start_rad = radians(table.number("start_deg", kAngle));
  path.rate_radps = radians(table.number_or("rate_degps", 0.0));
  if (auto sine = table.table_if_present("sine")) {
    path.sines.push_back({radians(sine->number("amplitude_deg", kAngle)), sine->number("period_s", kPositive),
                          sine->number_or("until_s", kAnyNumber.high)});
    sine->finish();
  }
  if (auto bend = table.table_if_present("bend")) {
    path.bends.push_back(
        {radians(bend->number("height_deg", kAngle)), bend->number("centre_s"), bend->number("width_s", kPositive)});
    bend->finish();
  }
  if (auto hyperbola = table.table_if_present("hyperbola")) {
    path.hyperbolas.push_back({radians(hyperbola->number("rate_degps")), hyperbola->number("centre_s"),
                               radians(hyperbola->number("closest_deg", {0.0, 90.0, true}))});
    hyperbola->finish();
  }
  return path;
}

}  // namespace truebearing
