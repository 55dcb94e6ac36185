// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tracker/step_log_scenario.hpp"

#include <fmt/format.h>
#include <utility>

#include "truebearing/core/error.hpp"
#include "truebearing/io/file.hpp"

namespace truebearing {

StepLogScenario::StepLogScenario(const StateSpace& space, StepLogFiles files, std::string tracker)
    : space_(&space), tracker_(std::move(tracker)) {
  training_.files = std::move(files.training);
  validation_.files = std::move(files.validation);
  evaluation_.files = std::move(files.evaluation);
}

std::vector<RecordedTrack> StepLogScenario::read(const std::filesystem::path& path) const {
  const StepLog log = read_step_log(path, tracker_);
  if (log.space != space_)
    throw InputError(path.string(), fmt::format("holds the state {}", fmt::join(log.space->components, ", ")),
                     fmt::format("columns x_ of {}", fmt::join(space_->components, ", ")));
  if (needs_innovation_ && !log.has_innovation)
    throw InputError(path.string(), "lacks columns of z, nu or S",
                     "all three, or `innovation = false` at the recorded tracker");
  return recordings_of(log, path.string());
}

const std::vector<Recording>& StepLogScenario::tracks(Role role) const {
  Logs& logs = role == Role::evaluation ? evaluation_ : role == Role::validation ? validation_ : training_;
  const std::lock_guard lock(mutex_);
  if (logs.tracks) return *logs.tracks;
  std::vector<Recording> tracks;
  for (const std::filesystem::path& pattern : logs.files)
    for (const std::filesystem::path& path : matching_files(pattern))
      for (RecordedTrack& track : read(path)) {
        if (!track.recording.truth_space)
          throw InputError(path.string(), "has no truth to teach or to score", "columns truth_<component>");
        tracks.push_back(std::move(track.recording));
      }
  return logs.tracks.emplace(std::move(tracks));
}

Recording StepLogScenario::simulate(const RunKey& key) const {
  const std::vector<Recording>& all = tracks(key.role);
  return all[static_cast<std::size_t>(key.run % all.size())];
}

std::string StepLogScenario::note() const {
  return fmt::format("recorded tracks: {}, a run each", tracks(Role::evaluation).size());
}

std::unique_ptr<Scenario> read_step_log_scenario(TableReader& table) {
  const auto files = [&](const char* key) {
    std::vector<std::filesystem::path> paths;
    for (const std::string& file : table.texts(key)) paths.push_back(table.resolve(file));
    if (paths.empty()) throw table.error(key, "names no file", "at least one step log");
    return paths;
  };
  StepLogFiles logs;
  logs.training = files("training");
  logs.validation = table.has("validation") ? files("validation") : logs.training;
  logs.evaluation = files("evaluation");
  const StateSpace& space =
      table.choice_or("space", {"line", "plane"}, "plane") == "line" ? line_space() : plane_space();
  return std::make_unique<StepLogScenario>(space, std::move(logs), table.text_or("tracker", ""));
}

}  // namespace truebearing
