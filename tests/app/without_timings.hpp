// SPDX-License-Identifier: Apache-2.0
// Results without the times that trackers took, the only figures that vary.
#pragma once

#include <regex>
#include <string>

namespace truebearing::testing {

inline std::string without_timings(const std::string& text) {
  static const std::regex timing("\"ns_per_step\": [^,\n]*");
  return std::regex_replace(text, timing, "");
}

}  // namespace truebearing::testing
