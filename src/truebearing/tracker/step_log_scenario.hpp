// SPDX-License-Identifier: Apache-2.0
// Step logs as a scenario (kind = "step_logs"): run k of a role replays track number k mod count of that role's logs,
// so that a tracker that runs elsewhere can be trained on and compared from its logs alone. Keys:
//   training, evaluation   arrays of files, relative to the scenario; * in a file's name stands for any text
//   validation             the training logs where it is absent; tuning always uses those
//   space                  of the logs' states: "plane" (as it is where absent) or "line"
//   tracker                whose rows, of logs that have a column `tracker`
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "truebearing/simulation/scenario.hpp"
#include "truebearing/tracker/step_log_recording.hpp"

namespace truebearing {

struct StepLogFiles {
  std::vector<std::filesystem::path> training;
  std::vector<std::filesystem::path> validation;
  std::vector<std::filesystem::path> evaluation;
};

class StepLogScenario final : public Scenario {
 public:
  /// Files are looked for, and read, when a run first needs them: a trained correction is applied without its teachers.
  StepLogScenario(const StateSpace& space, StepLogFiles files, std::string tracker = {});

  /// Throws InputError where no file matches, or a log has another state or no truth.
  Recording simulate(const RunKey& key) const override;
  const StateSpace& truth_space() const override { return *space_; }
  std::optional<Measured> measured() const override { return Measured::step_log(*space_); }
  std::optional<std::size_t> different_runs(Role role) const override { return tracks(role).size(); }
  std::string note() const override;

  /// The tracks of one log, with or without truth; "-" is standard input.
  std::vector<RecordedTrack> read(const std::filesystem::path& log) const;

  /// Logs without z, nu and S are refused from now on.
  void require_innovation() { needs_innovation_ = true; }

 private:
  struct Logs {
    std::vector<std::filesystem::path> files;
    std::optional<std::vector<Recording>> tracks;
  };
  const std::vector<Recording>& tracks(Role role) const;

  const StateSpace* space_;
  std::string tracker_;
  bool needs_innovation_ = false;
  mutable std::mutex mutex_;
  mutable Logs training_, validation_, evaluation_;
};

std::unique_ptr<Scenario> read_step_log_scenario(TableReader& table);

}  // namespace truebearing
