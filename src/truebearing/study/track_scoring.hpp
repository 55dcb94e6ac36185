// The part of a study's table [scoring] that is of several targets:
//   tracks = { quantity = "angle_deg", bad = 3.0, last_steps = 5, excursion = 6.0 }
//                                         swaps, losses and the squared errors of clean runs; last_steps is optional
//   gospa = { quantity = "angle_deg", cutoff = 5.0 }
//                                         of targets that appear and vanish: tracks belong to targets by assignment, so
//                                         that it does not go with `tracks`, which tells them by their numbers
//   angle_bound = { q_deg2ps3 = 0.03, rate_sigma_degps = 2.0, apart_deg = 10.0 }
//                                         what the angles of targets at a line array cannot be told better than
//                                         (evaluation/angle_bound.hpp); all of its keys are optional
#pragma once

#include <optional>

#include "truebearing/evaluation/angle_bound.hpp"
#include "truebearing/evaluation/run_score.hpp"
#include "truebearing/io/table_reader.hpp"

namespace truebearing {

/// Asks for the keys above, which go to `rule`. `truth` is the space of the scenario's.
void read_track_scoring(TableReader& scoring, const StateSpace& truth, ScoringRule& rule);

/// Asks for angle_bound.
std::optional<AngleBound> read_angle_bound(TableReader& scoring, const StateSpace& truth);

}  // namespace truebearing
