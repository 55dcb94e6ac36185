// SPDX-License-Identifier: Apache-2.0
#include "truebearing/simulation/look_schedule.hpp"

#include <algorithm>

#include "truebearing/core/constants.hpp"

namespace truebearing {

std::vector<Look> LookSchedule::draw(double period_s, int count, const RunKey& key) const {
  RandomStream stream(key, StreamId::schedule);
  const double period = period_factor.draw(stream) * period_s;
  const double missed_share = missed.draw(stream);
  const bool has_outages = stream.uniform() < outage_share;
  // A run begins somewhere between two outages.
  bool in_outage = false;
  double change_s = has_outages ? seen_s.draw(stream) * stream.uniform() : kInfinity;

  std::vector<Look> looks;
  const bool regular = gap_factor.is_fixed();
  const double gap_s = gap_factor.draw(stream) * period;
  double time_s = 0.0;
  for (int k = 1; k <= count; ++k) {
    time_s = regular ? k * gap_s : time_s + gap_factor.draw(stream) * period;
    while (time_s >= change_s) {
      in_outage = !in_outage;
      change_s += (in_outage ? unseen_s : seen_s).draw(stream);
    }
    const bool missed_it = missed_share > 0.0 && stream.uniform() < missed_share;
    looks.push_back({time_s, !in_outage && !missed_it});
  }
  if (std::none_of(looks.begin(), looks.end(), [](const Look& look) { return look.seen; })) looks.front().seen = true;
  return looks;
}

LookSchedule read_look_schedule(TableReader& scenario) {
  // Gaps of nothing would make a measurement of two; longer ones than these are another scenario.
  constexpr Range kFactor{1e-3, 1e3};
  constexpr Range kDuration{1e-3, 1e9};
  LookSchedule schedule;
  std::optional<TableReader> looks = scenario.table_if_present("looks");
  if (!looks) return schedule;
  schedule.period_factor = read_distribution_or(*looks, "period_factor", 1.0, kFactor);
  schedule.gap_factor = read_distribution_or(*looks, "gap_factor", 1.0, kFactor);
  schedule.missed = read_distribution_or(*looks, "missed", 0.0, {0.0, 1.0});
  schedule.outage_share = looks->number_or("outage_share", 0.0, {0.0, 1.0});
  if (schedule.outage_share > 0.0) {
    schedule.seen_s = read_distribution(*looks, "seen_s", kDuration);
    schedule.unseen_s = read_distribution(*looks, "unseen_s", kDuration);
  }
  schedule.empty_rows = looks->boolean_or("empty_rows", false);
  looks->finish();
  return schedule;
}

}  // namespace truebearing
