// SPDX-License-Identifier: Apache-2.0
// truebearing compare STUDY.toml: the study's trackers on Monte Carlo runs, scored against the truth.
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/compare_study.hpp"
#include "app/data_folder.hpp"
#include "app/output.hpp"
#include "app/ranks_of_mpirun.hpp"
#include "app/shard.hpp"
#include "app/subcommands.hpp"
#include "app/workflow.hpp"

namespace truebearing {
namespace {

struct CompareArguments {
  std::string study;
  std::optional<std::uint64_t> seed;
  bool retrain = false;
  bool all = false;
  std::string shard;
  CompareStudyOptions options;
};

// What cannot be shared among processes, or has nowhere to go.
void check_shard(const CompareArguments& arguments) {
  const auto refuse = [](const char* option, const char* found, const char* valid) {
    throw InputError(option, found, valid);
  };
  const CompareStudyOptions& options = arguments.options;
  if (options.details && arguments.shard.empty())
    refuse("--details", "is of a shard", "--shard I/N beside it, or --report");
  if (arguments.shard.empty()) return;
  if (options.json.empty()) refuse("--shard", "has no file to be written to", "--json FILE beside it");
  if (options.report.wanted()) refuse("--shard", "is no whole comparison to be drawn", "--details, and merge --report");
  if (arguments.retrain) refuse("--retrain", "would train in every shard", "train first, and shards of its models");
  if (!options.truth.empty()) refuse("--truth", "is of one process", "no --shard");
}

void compare_shard(const Study& study, const CompareArguments& arguments, const CompareStudyOptions& options) {
  const CorrectionModels models;
  StudyComparison comparison(study, models, options);
  const ShardHeader header{std::filesystem::absolute(study.path()).lexically_normal().string(),
                           hash_of_inputs(study),
                           options.seed,
                           comparison.options().runs,
                           arguments.all,
                           options.details,
                           Shard::parse(arguments.shard)};
  write_shard(comparison, header, options.json, options.quiet);
}

void run_compare(const CompareArguments& arguments, Ranks* ranks) {
  check_shard(arguments);
  if (!arguments.shard.empty()) {
    Shard::parse(arguments.shard);
    if (ranks) throw InputError("--shard", "is of one process", "mpirun without it");
  }
  Study study = Study::load(arguments.study);
  if (arguments.all) study.show_all();
  CompareStudyOptions options = arguments.options;
  options.seed = arguments.seed.value_or(study.seed());
  std::vector<std::filesystem::path> inputs = study.input_files();
  if (!options.truth.empty()) inputs.emplace_back(options.truth);
  if (is_first(ranks)) check_outputs(options.report, {options.json}, inputs);
  check_ranks(ranks, inputs,
              fmt::format("{} {} {} {} {}", options.seed, options.runs, arguments.all, arguments.retrain,
                          options.details || options.report.wanted()));
  if (!is_first(ranks)) options.quiet = true;
  if (!arguments.shard.empty()) return compare_shard(study, arguments, options);
  CorrectionModels models;
  if (arguments.retrain) {
    const WorkflowOptions workflow{options.seed, options.threads, options.quiet, ranks};
    study.set_parameters(tune_study(study, workflow));
    models = train_study(study, {}, workflow);
  }
  compare_study(study, models, options, ranks);
}

}  // namespace

void add_compare(const Subcommands& all) {
  auto arguments = std::make_shared<CompareArguments>();
  CompareStudyOptions& options = arguments->options;
  const Subcommand command = all.add("compare", "run the study's trackers on held-out runs and compare their errors");
  add_study(command, arguments->study);
  command.argument("--seed", arguments->seed, "seed; the study's own where not given");
  command.argument("--runs", options.runs, "runs; the study's own number where not given").within(1, kMostRuns);
  command.argument("--threads", options.threads, "0: one per core").within(0, 1024);
  command.argument("--truth", options.truth,
                   "a recorded track (log with truth, or positions), measured afresh in every run; or a line array's "
                   "log with truth, replayed");
  add_log_arguments(command, options.reading);
  command.flag("--retrain", arguments->retrain, "tune and train afresh with this seed; files are left alone");
  command.argument("--json", options.json, "write the results as JSON; - is standard output");
  command.argument("--shard", arguments->shard,
                   "I/N: only part I of N of the runs, from 1/N to N/N, written to --json for `merge`");
  command.flag("--details", options.details, "in a shard: keep what merge --report draws");
  add_report_arguments(command, options.report);
  add_table_arguments(command, options.tables);
  command.flag("--all", arguments->all, "with trackers that the study does not show");
  command.flag("--quiet", options.quiet, "no progress");
  command.runs([arguments] { with_ranks([&](Ranks* ranks) { run_compare(*arguments, ranks); }); });
}

}  // namespace truebearing
