// SPDX-License-Identifier: Apache-2.0
// The keys of a study's table [scoring] that compare its figures at given times with what can be reached:
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

/// Asks for the keys above. `truth` is the space of the scenario's; `rule` has the times.
TimedScoring read_timed_scoring(TableReader& scoring, const StateSpace& truth, const ScoringRule& rule);

}  // namespace truebearing
