// SPDX-License-Identifier: Apache-2.0
// A study of recorded flights, as the text of its file: one plain filter, its own little scenario, positions measured to 50 m.
#pragma once

#include <string>

namespace truebearing::testing {

inline const std::string kFlightStudy = R"(name = "flight"
runs = 4

[recorded]
position_sigma_m = 50.0
max_speed_mps = 400.0

[scenario]
kind = "planar_flight"
output = "plane"
period_s = 1.0
steps = 5
flight = { speed_mps = 100.0, leg_s = 20.0, turn_s = 20.0, turn_rate_degps = 3.0, roll_in_s = 3.0 }
site = { closest_m = 0.0 }
sensor = { position_sigma_m = 50.0 }

[trackers.plain]
kind = "kalman"
space = "plane"
motion = { model = "constant_velocity", noise = "discrete", sigma_a_mps2 = 3.0 }
measurement = { model = "position", sigma_m = 50.0 }
start = { kind = "two_point" }
)";

}  // namespace truebearing::testing
