// SPDX-License-Identifier: Apache-2.0
// truebearing simulate SCENARIO.toml --seed S --runs N -o DIR [--track FILE --track-id K --track-from S]:
// measurement logs with truth.
#include <cstdint>
#include <filesystem>
#include <fmt/format.h>
#include <memory>
#include <system_error>
#include <toml++/toml.h>
#include <utility>
#include <vector>

#include "app/data_folder.hpp"
#include "app/output.hpp"
#include "app/subcommands.hpp"
#include "truebearing/core/error.hpp"
#include "truebearing/io/file.hpp"
#include "truebearing/io/table_reader.hpp"
#include "truebearing/recording/recording_csv.hpp"
#include "truebearing/recording/snapshot_log.hpp"
#include "truebearing/simulation/bearings_of_track.hpp"

namespace truebearing {
namespace {

struct SimulateArguments {
  std::string scenario;
  std::string folder;
  std::string track;
  std::string track_id;
  double track_from_s = 0.0;
  std::uint64_t seed = 1;
  std::size_t runs = 1;
  bool quiet = false;
};

// A scenario's file, or the scenario that a study has.
std::unique_ptr<Scenario> scenario_in(const std::filesystem::path& path) {
  TableReader file(read_toml_file(path), path.string());
  if (file.has("kind") || !file.has("scenario")) return load_scenario(path);
  const toml::node* scenario = file.node("scenario");
  if (scenario->is_table()) return read_scenario(file.table("scenario"));
  return load_scenario(file.resolve(file.text("scenario")));
}

std::unique_ptr<Scenario> scenario_of(const SimulateArguments& options) {
  std::unique_ptr<Scenario> scenario = scenario_in(options.scenario);
  if (options.track.empty()) return scenario;
  const auto* bearings = dynamic_cast<const BearingsOnlyScenario*>(scenario.get());
  if (!bearings)
    throw InputError(options.scenario, "has no target that --track could stand for",
                     "a scenario of kind \"bearings_only\" or \"passive_sonar\"");
  RecordingOptions reading;
  reading.target = options.track_id;
  Recording track = read_target_track(options.track, reading);
  try {
    return std::make_unique<BearingsOfTrack>(std::move(track), options.track_from_s, bearings->parameters());
  } catch (const InputError& error) {
    throw InputError(options.track, error.found(), error.valid());
  }
}

std::filesystem::path log_path(const SimulateArguments& options, std::size_t run, const char* extension) {
  return std::filesystem::path(options.folder) / fmt::format("run_{:04}{}", run, extension);
}

// As a measurement log, or a snapshot log of a line array.
void write_log(const SimulateArguments& options, std::size_t run, const Recording& recording) {
  if (measures_snapshots(recording.measured))
    write_snapshot_log(log_path(options, run, ".h5"), recording);
  else
    write_file_atomically(log_path(options, run, ".csv"), write_recording(recording));
}

// A track that lies among the logs would be overwritten by one of them.
void check_logs(const SimulateArguments& options) {
  std::error_code unknown;
  if (!std::filesystem::exists(options.folder, unknown)) return;
  std::vector<std::filesystem::path> inputs{options.scenario};
  if (!options.track.empty()) inputs.emplace_back(options.track);
  for (std::size_t run = 0; run < options.runs; ++run)
    for (const char* extension : {".csv", ".h5"})
      if (const std::filesystem::path log = log_path(options, run, extension); std::filesystem::exists(log, unknown))
        check_outputs({log.string()}, inputs);
}

void simulate(const SimulateArguments& options) {
  check_logs(options);
  const std::unique_ptr<Scenario> scenario = scenario_of(options);
  std::error_code failure;
  std::filesystem::create_directories(options.folder, failure);
  if (failure) throw InputError(options.folder, "cannot be made: " + failure.message(), "a folder to write to");
  ProgressLine progress("simulate", options.quiet);
  for (std::size_t run = 0; run < options.runs; ++run) {
    const Recording recording = scenario->simulate({options.seed, Role::evaluation, run});
    write_log(options, run, recording);
    progress.show(run + 1, options.runs);
  }
}

}  // namespace

void add_simulate(const Subcommands& all) {
  auto options = std::make_shared<SimulateArguments>();
  const Subcommand command = all.add("simulate", "write measurement logs with truth");
  add_scenario(command, options->scenario);
  command.argument("-o,--output", options->folder, "folder for run_0000.csv, run_0001.csv, ... (.h5 of a line array)")
      .required();
  command.argument("--seed", options->seed, "seed of the random streams").default_shown();
  command.argument("--runs", options->runs, "number of logs").default_shown().within(1, 1000000);
  const Argument track = command.argument(
      "--track", options->track,
      "a recorded track (positions, or a log with truth) as the target of a bearings_only or passive_sonar one");
  command.argument("--track-id", options->track_id, "which one of the file").needs(track);
  command.argument("--track-from", options->track_from_s, "time in the track, in s, at which it begins").needs(track);
  command.flag("--quiet", options->quiet, "no progress");
  command.runs([options] { simulate(*options); });
}

}  // namespace truebearing
