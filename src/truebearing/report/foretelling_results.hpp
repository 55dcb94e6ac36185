// SPDX-License-Identifier: Apache-2.0
// What trackers foretold of measurements that were hidden from them, as a page shows it: from the key `foretelling` of
// the JSON that `track --foretell N --json` writes.
#pragma once

#include <string>
#include <vector>

#include "truebearing/core/constants.hpp"

namespace truebearing {

struct ForetellingResults {
  double track = kNaN;                  ///< number of the log's track
  double steps = kNaN;                  ///< ahead
  double measurements = kNaN;           ///< that were foretold
  std::string quantity, best, says;     ///< "position_m"; who foretells best; the verdict in a sentence
  std::vector<std::string> left_out{};  ///< who has no estimate where measurements are hidden

  struct Tracker {
    std::string name;
    double rmse = kNaN, rmse_se = kNaN;
    double above_best = kNaN,
           above_best_se = kNaN;  ///< mean squared error less that of the best, run for run of the log
    double mean_gate = kNaN;      ///< of a correction
  };
  std::vector<Tracker> trackers{};
};

class ResultReader;
/// One per track of a log; none where the results have no such key. Throws InputError as its reader does.
std::vector<ForetellingResults> read_foretelling(const ResultReader& results);

/// As a section of a page; empty where there is none.
std::string foretelling_section(const std::vector<ForetellingResults>& all);

}  // namespace truebearing
