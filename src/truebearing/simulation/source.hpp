// SPDX-License-Identifier: Apache-2.0
// What a target radiates: a tone of one frequency that may jump to another.
#pragma once

#include <vector>

#include "truebearing/core/random.hpp"
#include "truebearing/io/table_reader.hpp"
#include "truebearing/simulation/distribution.hpp"

namespace truebearing {

/// The frequency of one source over time.
class SourceTone {
 public:
  struct Level {
    double begin_s;
    double frequency_hz;
  };
  explicit SourceTone(double frequency_hz) : levels_{{0.0, frequency_hz}} {}
  /// Another frequency from `begin_s` on; where the last change comes later, from there on.
  void change(double begin_s, double frequency_hz);

  /// At `time_s` >= 0.
  double at(double time_s) const;
  double last_hz() const { return levels_.back().frequency_hz; }

 private:
  std::vector<Level> levels_;
};

/// A source of a scenario; each run draws one.
struct SourceParameters {
  Distribution frequency_hz = 100.0;  ///< at time 0
  /// Jumps to a frequency, or by a difference from the one before.
  struct Change {
    Distribution time_s = 0.0;
    Distribution hz = 0.0;
    bool is_frequency = false;
    double share = 1.0;  ///< probability that it happens at all
  };
  std::vector<Change> changes;

  /// Throws InputError where changes add up to a frequency that is not positive.
  SourceTone draw(RandomStream& stream) const;
};

/// The keys frequency_hz, changes of a source's table.
SourceParameters read_source(TableReader& table);

}  // namespace truebearing
