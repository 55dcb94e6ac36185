// SPDX-License-Identifier: Apache-2.0
#include "truebearing/simulation/source.hpp"

#include <algorithm>
#include <fmt/format.h>

#include "truebearing/core/error.hpp"

namespace truebearing {

void SourceTone::change(double begin_s, double frequency_hz) {
  levels_.push_back({std::max(begin_s, levels_.back().begin_s), frequency_hz});
}

double SourceTone::at(double time_s) const {
  // A sample that rounding puts before a change by this much still has the new frequency.
  constexpr double kRounding_s = 1e-9;
  const auto after = std::find_if(levels_.begin() + 1, levels_.end(),
                                  [&](const Level& level) { return level.begin_s > time_s + kRounding_s; });
  return (after - 1)->frequency_hz;
}

SourceTone SourceParameters::draw(RandomStream& stream) const {
  SourceTone tone(frequency_hz.draw(stream));
  for (const Change& change : changes) {
    const double time_s = change.time_s.draw(stream), hz = change.hz.draw(stream);
    if (change.share < 1.0 && stream.uniform() >= change.share) continue;
    tone.change(time_s, change.is_frequency ? hz : tone.last_hz() + hz);
    if (!(tone.last_hz() > 0.0))
      throw InputError("source.changes", fmt::format("lead to a frequency of {:g} Hz", tone.last_hz()), "one > 0");
  }
  return tone;
}

SourceParameters read_source(TableReader& table) {
  SourceParameters source;
  source.frequency_hz = read_distribution(table, "frequency_hz", kPositive);
  for (TableReader& read : table.tables("changes")) {
    SourceParameters::Change change;
    change.is_frequency = read.one_of("to_hz", "by_hz") == "to_hz";
    change.time_s = read_distribution(read, "time_s", {0.0, 1e6});
    change.hz = change.is_frequency ? read_distribution(read, "to_hz", kPositive) : read_distribution(read, "by_hz");
    change.share = read.number_or("share", 1.0, {0.0, 1.0});
    read.finish();
    source.changes.push_back(change);
  }
  return source;
}

}  // namespace truebearing
