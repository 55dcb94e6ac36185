// SPDX-License-Identifier: Apache-2.0
#include "app/tracked_log.hpp"

#include <nlohmann/json.hpp>

#include "truebearing/study/study_sites.hpp"

namespace truebearing {

TrackedLog tracked_log(const Study& study, const std::string& log, const TrackRun& run, const Recording::Counts& rows,
                       const KeptLogs& logs) {
  LogFollower follower(run.trackers(), sensor_sites(study));
  for (const auto& [number, recording] : logs) follower.follow(recording, number, run.contents().epoch_s);
  TrackedLog tracked{study.name(), log, run.contents().measurements, rows, {}, follower.take()};
  for (const Followed& followed : run.all())
    tracked.why_none.push_back(followed.records > 0 ? "" : why_no_track(study, followed.name, run.contents()));
  return tracked;
}

nlohmann::ordered_json run_json(const Study& study, const std::string& log, const TrackerSet& trackers,
                                const Scenario& recorded, const RunKey& key) {
  KeptLogs logs;
  logs.emplace_back(0, recorded.simulate(key));
  const Recording& recording = logs.front().second;
  TrackRun run(trackers.fresh());
  run.foresee(recording.measurements);
  for (const Measurement& measurement : recording.measurements) run.step(measurement);
  run.end_track(recording.counts);
  TrackedLog tracked = tracked_log(study, log, run, recording.counts, logs);
  tracked.run = key.run;
  nlohmann::ordered_json json = log_json(tracked, run.all());
  json.erase("picture");
  return json;
}

}  // namespace truebearing
