// SPDX-License-Identifier: Apache-2.0
// Who of the trackers on a log foretells best (evaluation/foretelling.hpp), log by log: `truebearing track --foretell`.
#pragma once

#include <string>
#include <vector>

#include "app/tracked_log.hpp"
#include "truebearing/evaluation/foretelling.hpp"

namespace truebearing {

struct ForetoldLog {
  int number;
  Foretelling told;
};

/// Of each log, in the trackers' time, which begins at epoch_s of the log's. Says of `log` where nothing could be foretold.
std::vector<ForetoldLog> foretell(const TrackerSet& trackers, const std::string& log, const KeptLogs& logs,
                                  double epoch_s, int steps, const SensorSites& sites);

/// The results, which are JSON, with a key `foretelling`; as they are where nothing was foretold.
std::string with_foretelling(std::string results, const std::vector<ForetoldLog>& all);

}  // namespace truebearing
