// SPDX-License-Identifier: Apache-2.0
// The key of a study's table [scoring] that asks for the bounds of several targets:
//   angle_bound = { q_deg2ps3 = 0.03, rate_sigma_degps = 2.0, apart_deg = 10.0 }
//                                         what the angles of targets at a line array cannot be told better than
//                                         (evaluation/angle_bound.hpp); all of its keys are optional
#pragma once

#include <optional>

#include "truebearing/evaluation/angle_bound.hpp"
#include "truebearing/io/table_reader.hpp"

namespace truebearing {

/// Asks for angle_bound. `truth` is the space of the scenario's.
std::optional<AngleBound> read_angle_bound(TableReader& scoring, const StateSpace& truth);

}  // namespace truebearing
