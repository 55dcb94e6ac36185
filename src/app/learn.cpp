// SPDX-License-Identifier: Apache-2.0
// truebearing learn STUDY.toml [-o FOLDER] [--report PAGE.html]: tunes, trains, compares and reports in one go.
#include <cstdint>
#include <filesystem>
#include <fmt/format.h>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "app/compare_study.hpp"
#include "app/data_folder.hpp"
#include "app/output.hpp"
#include "app/ranks_of_mpirun.hpp"
#include "app/subcommands.hpp"
#include "app/terminal.hpp"
#include "app/workflow.hpp"
#include "truebearing/core/error.hpp"

namespace truebearing {
namespace {

namespace fs = std::filesystem;

struct LearnArguments {
  std::string study;
  std::string folder;
  std::optional<std::uint64_t> seed;
  CompareStudyOptions options;
};

// Where it is written what the study calls `own`.
std::string output_of(const LearnArguments& arguments, const fs::path& own) {
  return arguments.folder.empty() ? own.string() : (fs::path(arguments.folder) / own.filename()).string();
}

void make_folder(const std::string& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw InputError(folder, "cannot be made: " + error.message(), "a folder");
}

void learn(const LearnArguments& arguments, Ranks* ranks) {
  Study study = Study::load(arguments.study);
  CompareStudyOptions options = arguments.options;
  options.seed = arguments.seed.value_or(study.seed());
  const bool tunes = has_tuned_trackers(study);
  const std::vector<std::string> names = corrected_trackers(study, {}), learned = learned_trackers(study, {});
  if (!tunes && names.empty() && learned.empty())
    throw InputError(arguments.study, "has nothing to learn", "a tracker with a key `tune`, or of kind \"corrected\"");
  if (tunes && study.parameters_path().empty())
    throw InputError(arguments.study, "has no key `parameters`", "that key");
  if (!learned.empty() && !arguments.folder.empty())
    throw InputError("-o", "stands beside a motion that is learned, which is read where the study names it", "no -o");
  for (const std::string& output : {options.json, options.report.page})
    if (is_standard_output(output))
      throw InputError("learn", "says on standard output what it has written", "a file for --json and --report");
  std::vector<fs::path> own;
  if (tunes) own.push_back(study.parameters_path());
  for (const std::string& name : names) own.push_back(study.tracker(name).correction->model);
  for (const std::string& name : learned) own.push_back(study.tracker(name).learned->file);
  options.quiet = options.quiet || !is_first(ranks);
  check_ranks(ranks, inputs_without(study, own), fmt::format("{} {}", options.seed, options.runs));
  if (is_first(ranks) && !arguments.folder.empty()) make_folder(arguments.folder);
  std::vector<std::string> outputs, models_to_write;
  for (const fs::path& file : own) outputs.push_back(output_of(arguments, file));
  for (const std::string& name : names)
    models_to_write.push_back(output_of(arguments, study.tracker(name).correction->model));
  outputs.push_back(options.json);
  if (is_first(ranks)) check_outputs(options.report, outputs, inputs_without(study, own));

  WorkflowOptions workflow{options.seed, options.threads, options.quiet, ranks};
  keep_checkpoints(study, names, models_to_write, workflow);
  std::vector<std::string> motions;
  for (const std::string& name : learned) motions.push_back(study.tracker(name).learned->file.string());
  train_motions(study, learned, motions, workflow);  // first: filters that are tuned may have them
  if (tunes) {
    const ParametersFile parameters = tune_study(study, workflow);
    if (is_first(ranks)) write_parameters(outputs.front(), parameters);
    // With the digits of the file: a model belongs to these.
    study.set_parameters(parse_parameters(parameters_text(parameters), outputs.front()));
  }
  const CorrectionModels models = train_study(study, {}, workflow);
  if (is_first(ranks))
    for (std::size_t i = 0; i < names.size(); ++i) write_model(models_to_write[i], *models.at(names[i]));
  compare_study(study, models, options, ranks);
  if (is_first(ranks) && !arguments.folder.empty()) {
    std::vector<std::string> named;
    for (const fs::path& file : own) named.push_back(file.filename().string());
    say(fmt::format(
        "truebearing: {} reads what was learned where it names {}: move them there from {}, or name them there",
        arguments.study, fmt::join(named, ", "), arguments.folder));
  }
}

}  // namespace

void add_learn(const Subcommands& all) {
  auto arguments = std::make_shared<LearnArguments>();
  CompareStudyOptions& options = arguments->options;
  const Subcommand command = all.add("learn", "tune, train, compare and report in one go");
  add_study(command, arguments->study);
  command.argument("-o,--output", arguments->folder,
                   "folder for parameters and models; where the study names them if not given");
  command.argument("--seed", arguments->seed, "seed; the study's own where not given");
  command.argument("--runs", options.runs, "runs that are compared; the study's own number where not given")
      .within(1, kMostRuns);
  command.argument("--threads", options.threads, "0: one per core").within(0, 1024);
  command.argument("--json", options.json, "write the results as JSON");
  add_report_arguments(command, options.report);
  add_table_arguments(command, options.tables);
  command.flag("--quiet", options.quiet, "no progress");
  command.runs([arguments] { with_ranks([&](Ranks* ranks) { learn(*arguments, ranks); }); });
}

}  // namespace truebearing
