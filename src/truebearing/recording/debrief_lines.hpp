// SPDX-License-Identifier: Apache-2.0
// The lines of a Debrief replay file (debrief_replay.hpp), as they are told: degrees, knots, yards, Hz; NaN for NULL.
#pragma once

#include <cstddef>
#include <istream>
#include <string>
#include <utility>
#include <vector>

#include "truebearing/core/constants.hpp"

namespace truebearing {

struct DebriefFix {
  double time_s = kNaN, latitude_deg = kNaN, longitude_deg = kNaN, course_deg = kNaN, speed_kn = kNaN;
};

/// What a sensor of a vessel measured; of a position only the vessel and its fix.
struct DebriefLine {
  std::string track{}, sensor{};
  DebriefFix from{};  ///< of a sensor the place alone, where it tells one
  double bearing_deg = kNaN, bearing_sigma_deg = kNaN, frequency_hz = kNaN, frequency_sigma_hz = kNaN, range_yd = kNaN;
};

struct DebriefLines {
  std::vector<std::pair<std::size_t, DebriefLine>> positions{}, contacts{};  ///< with their numbers in the file, from 1
};

/// Throws InputError that names `name` and the line.
DebriefLines read_debrief_lines(std::istream& stream, const std::string& name);

}  // namespace truebearing
