// SPDX-License-Identifier: Apache-2.0
// What a target is doing, told by its first turn: the phases by which a comparison tells errors apart.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "truebearing/io/table_reader.hpp"
#include "truebearing/simulation/vessel.hpp"

namespace truebearing {

/// With after_s = {200, 500}: "before" the turn, in the "turn", "after_200" (up to 200 s after its end), "after_500"
/// (from there to 500 s after), "later", and "quiet" for a target that does not turn. Where sharp turns are told apart,
/// theirs are "sharp_turn", "sharp_after_200" and "sharp_after_500". A step at the end of one belongs to it.
struct TurnPhases {
  std::vector<double> after_s;                                 ///< > 0, ascending
  double from_s = 0.0;                                         ///< steps before it belong to no phase
  double sharp_rad = std::numeric_limits<double>::infinity();  ///< turns by that or more are sharp

  std::vector<std::string> names() const;
  /// Place in names(), -1 before from_s.
  int at(double time_s, const std::optional<VesselPath::Turn>& turn) const;
};

/// The keys after_s, from_s, sharp_deg of a table [phases].
TurnPhases read_turn_phases(TableReader& table);

}  // namespace truebearing
