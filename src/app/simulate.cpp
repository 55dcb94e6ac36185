// truebearing simulate SCENARIO.toml --seed S --runs N -o DIR: measurement logs with truth.
#include <filesystem>
#include <fmt/format.h>
#include <memory>

#include "app/output.hpp"
#include "app/subcommands.hpp"
#include "truebearing/core/error.hpp"
#include "truebearing/io/file.hpp"
#include "truebearing/measurement/recording_csv.hpp"
#include "truebearing/simulation/scenario.hpp"

namespace truebearing {
namespace {

struct Options {
  std::string scenario;
  std::string folder;
  std::uint64_t seed = 1;
  std::size_t runs = 1;
  bool quiet = false;
};

void simulate(const Options& options) {
  const std::unique_ptr<Scenario> scenario = load_scenario(options.scenario);
  std::error_code failure;
  std::filesystem::create_directories(options.folder, failure);
  if (failure) throw InputError(options.folder, "cannot be made: " + failure.message(), "a folder to write to");
  ProgressLine progress("simulate", options.quiet);
  for (std::size_t run = 0; run < options.runs; ++run) {
    const Recording recording = scenario->simulate({options.seed, Role::evaluation, run});
    write_file_atomically(std::filesystem::path(options.folder) / fmt::format("run_{:04}.csv", run),
                          write_recording(recording));
    progress.show(run + 1, options.runs);
  }
}

}  // namespace

void add_simulate(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("simulate", "write measurement logs with truth");
  command->add_option("scenario", options->scenario, "scenario file (TOML)")->required();
  command->add_option("-o,--output", options->folder, "folder for run_0000.csv, run_0001.csv, ...")->required();
  command->add_option("--seed", options->seed, "seed of the random streams")->capture_default_str();
  command->add_option("--runs", options->runs, "number of logs")->capture_default_str()->check(CLI::Range(1, 1000000));
  command->add_flag("--quiet", options->quiet, "no progress");
  command->callback([options] { simulate(*options); });
}

}  // namespace truebearing
