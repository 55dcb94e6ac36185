// The part of a study's table [scoring] that asks for figures at given times:
//   times_s = [280.0, ...]                ascending
//   target_motion = true                  with errors in range, course and speed, relative to own ship
//   global_minimum = "ml_225"             the batch tracker whose costs the others' are compared with
//   bound = { kind = "cramer_rao", prior = { kind = "range", ... }, q_m2ps3, bearing_sigma_deg }
//                                         all but the kind optional: range_prior_configuration.hpp has the prior's keys
#pragma once

#include <optional>
#include <string>

#include "truebearing/evaluation/comparison.hpp"
#include "truebearing/io/table_reader.hpp"

namespace truebearing {

struct TimedScoring {
  std::string global_minimum;  ///< or empty
  std::optional<TargetMotionBound> cramer_rao;
};

/// Asks for the keys above; times_s and target_motion go to `rule`. `truth` is the space of the scenario's.
TimedScoring read_timed_scoring(TableReader& scoring, const StateSpace& truth, ScoringRule& rule);

}  // namespace truebearing
