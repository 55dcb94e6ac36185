// SPDX-License-Identifier: Apache-2.0
// When a sensor looks, and when it sees: the table [looks] of a scenario. Without it a sensor looks once per period and
// misses nothing. Each run draws its own period, gaps, misses and outages, from a stream of their own: what a target does
// does not depend on when it is looked at.
#pragma once

#include <vector>

#include "truebearing/core/random.hpp"
#include "truebearing/simulation/distribution.hpp"

namespace truebearing {

struct Look {
  double time_s;
  bool seen;
};

struct LookSchedule {
  Distribution period_factor = 1.0;  ///< of the scenario's period, drawn once per run
  Distribution gap_factor = 1.0;     ///< of that period, drawn for each gap between looks
  Distribution missed = 0.0;         ///< probability that a look sees nothing, drawn once per run
  double outage_share = 0.0;         ///< probability that a run has outages:
  Distribution seen_s = 10.0;        ///< times between them,
  Distribution unseen_s = 10.0;      ///< and how long each lasts, each drawn anew
  bool empty_rows = false;           ///< a look that sees nothing leaves an empty measurement, else none

  /// `count` looks, the first one period after 0. Of these at least one is seen.
  std::vector<Look> draw(double period_s, int count, const RunKey& key) const;
  /// Whether a measurement stands in the recording for that look.
  bool keeps(const Look& look) const { return look.seen || empty_rows; }
};

/// Reads [looks], where the scenario has one.
LookSchedule read_look_schedule(TableReader& scenario);

}  // namespace truebearing
