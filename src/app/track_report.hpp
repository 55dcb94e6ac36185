// SPDX-License-Identifier: Apache-2.0
// What `truebearing track` says of the trackers that it ran, for people; and of a log without truth, for programs.
#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "truebearing/evaluation/innovation_consistency.hpp"
#include "truebearing/evaluation/log_account.hpp"
#include "truebearing/tracker/tracker.hpp"

namespace truebearing {

/// One tracker on the log.
struct Followed {
  std::string name;
  long records = 0;
  InnovationConsistency innovations;
  std::map<std::string, InnovationConsistency> of_sensors;  ///< the same of each of several; empty where there is one
  TrackerCounts counts;
  std::vector<TrackEvent> events;  ///< times are those of the log
  std::vector<StepRecord> last;    ///< of the last step; empty where the track had ended, or none began
};

/// Steps, NIS and whiteness with what is outside its interval marked, and what trackers met.
std::string consistency_table(const std::vector<Followed>& all);
/// Lines about innovations that are far from the size that their tracker claims.
std::vector<std::string> consistency_warnings(const std::vector<Followed>& all);
/// The state with its standard deviations at the end, track by track.
std::string estimate_table(const std::vector<Followed>& all);
std::string event_table(const std::vector<Followed>& all);

/// What a log was and what became of it.
struct TrackedLog {
  std::string study, log;
  std::size_t measurements = 0;
  Recording::Counts rows;
  std::vector<std::string> why_none;  ///< [tracker]: why it began no track; empty where it did
  LogAccount account;
  std::optional<std::size_t> run = {};  ///< of a truth that is measured afresh in each, from 0
};

/// As JSON: consistency, last estimates, innovations, what was not used and why, events, and the picture of the tracks.
nlohmann::ordered_json log_json(const TrackedLog& tracked, const std::vector<Followed>& all);

}  // namespace truebearing
