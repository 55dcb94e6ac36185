// SPDX-License-Identifier: Apache-2.0
// What a log says without its truth, of the trackers that ran on it: of `track`, and of one run of `compare --truth`.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "app/track_report.hpp"
#include "app/track_run.hpp"
#include "truebearing/simulation/scenario.hpp"

namespace truebearing {

/// Logs that are kept, each with the number that tells its tracks from others'.
using KeptLogs = std::vector<std::pair<int, Recording>>;

/// run: of the trackers on these logs. rows: of them. log: what it is called.
TrackedLog tracked_log(const Study& study, const std::string& log, const TrackRun& run, const Recording::Counts& rows,
                       const KeptLogs& logs);

/// The same of one run of a recorded truth, as JSON without a picture of its tracks, which a comparison has.
nlohmann::ordered_json run_json(const Study& study, const std::string& log, const TrackerSet& trackers,
                                const Scenario& recorded, const RunKey& key);

}  // namespace truebearing
