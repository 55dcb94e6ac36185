// SPDX-License-Identifier: Apache-2.0
// How the angle of a target goes with time: a start, a constant rate, and terms that bend it.
//     angle(t) = start + rate t + sum of   amplitude sin(2 pi min(t, until) / period)
//                                          height tanh((t - centre) / width)
//                                          +- sqrt((rate (t - centre))^2 + closest^2)
#pragma once

#include <vector>

#include "truebearing/io/table_reader.hpp"

namespace truebearing {

struct AnglePath {
  struct Sine {
    double amplitude_rad, period_s, until_s;
  };
  struct Bend {
    double height_rad, centre_s, width_s;
  };
  struct Hyperbola {
    double rate_radps, centre_s, closest_rad;
  };

  double start_rad = 0.0;
  double rate_radps = 0.0;
  std::vector<Sine> sines;
  std::vector<Bend> bends;
  std::vector<Hyperbola> hyperbolas;

  double angle_rad(double time_s) const;
  double rate_at_radps(double time_s) const;
};

/// Keys start_deg, rate_degps, sine = { amplitude_deg, period_s, until_s }, bend = { height_deg, centre_s, width_s },
/// hyperbola = { rate_degps, centre_s, closest_deg }; all but the first optional.
AnglePath read_angle_path(TableReader& table);

}  // namespace truebearing
