// SPDX-License-Identifier: Apache-2.0
// The units that names of columns may end in, and what a number of each is multiplied by. Inside, lengths are metres,
// speeds m/s, angles radians, frequencies Hz.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace truebearing {

enum class Dimension { length, speed, acceleration, angle, angular_rate, frequency, time };

struct Unit {
  std::string_view suffix;  ///< "km" of "range_km"
  Dimension dimension;
  double factor;            ///< from a number of the file to one of the program
  std::string_view stands;  ///< the unit in the name under which the program knows it: "m"
};

std::span<const Unit> known_units();

/// "range_km" apart: "range" and the unit; no unit where the name ends in none that is known.
struct NameAndUnit {
  std::string_view stem;
  const Unit* unit = nullptr;

  /// "range_m".
  std::string standard_name() const;
};
NameAndUnit apart(std::string_view column);

/// The suffixes of one dimension or of all, for an error: "_m, _km, _nmi".
std::string suffixes_of(Dimension dimension);
std::string all_suffixes();

}  // namespace truebearing
