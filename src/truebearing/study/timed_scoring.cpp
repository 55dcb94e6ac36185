// SPDX-License-Identifier: Apache-2.0
#include "truebearing/study/timed_scoring.hpp"

#include "truebearing/core/angle.hpp"
#include "truebearing/study/range_prior_configuration.hpp"

namespace truebearing {
namespace {

TargetMotionBound read_bound(TableReader table) {
  table.choice("kind", {"cramer_rao"});
  TargetMotionBound bound;
  bound.q_m2ps3 = table.number_or("q_m2ps3", 0.0, kNonNegative);
  if (table.has("bearing_sigma_deg"))
    bound.bearing_sigma_rad = radians(table.number("bearing_sigma_deg", {0.0, 90.0, true}));
  bound.frequencies = table.boolean_or("frequencies", true);
  if (table.has("frequency_sigma_hz")) bound.frequency_sigma_hz = table.number("frequency_sigma_hz", kPositive);
  if (table.has("range_sigma_m")) bound.range_sigma_m = table.number("range_sigma_m", kPositive);
  bound.range_rates = table.boolean_or("range_rates", true);
  if (table.has("range_rate_sigma_mps")) bound.range_rate_sigma_mps = table.number("range_rate_sigma_mps", kPositive);
  bound.range_rate_correlation = table.number_or("range_rate_correlation", 0.0, {-0.999, 0.999});
  bound.sound_mps = table.number_or("sound_mps", kSoundInWater_mps, kPositive);
  if (table.has("prior")) bound.prior = read_range_prior(table.table("prior"));
  table.finish();
  return bound;
}

}  // namespace

TimedScoring read_timed_scoring(TableReader& scoring, const StateSpace& truth, const ScoringRule& rule) {
  TimedScoring timed;
  if (scoring.has("global_minimum")) timed.global_minimum = scoring.text("global_minimum");
  if (auto bound = scoring.table_if_present("bound")) timed.cramer_rao = read_bound(std::move(*bound));
  if (scoring.has("bound") && !begins_in_plane(truth))
    throw scoring.error("bound", "is of a target in the plane, and the scenario's truth is " + truth.name);
  for (const char* key : {"global_minimum", "bound"})
    if (scoring.has(key) && rule.times_s.empty())
      throw scoring.error(key, "stands without times_s", "a key times_s beside it");
  return timed;
}

}  // namespace truebearing
