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
#include "app/subcommands.hpp"
#include "app/workflow.hpp"

namespace truebearing {
namespace {

struct CompareArguments {
  std::string study;
  std::optional<std::uint64_t> seed;
  bool retrain = false;
  bool all = false;
  CompareStudyOptions options;
};

void run_compare(const CompareArguments& arguments) {
  Study study = Study::load(arguments.study);
  if (arguments.all) study.show_all();
  CompareStudyOptions options = arguments.options;
  options.seed = arguments.seed.value_or(study.seed());
  std::vector<std::filesystem::path> inputs = study.input_files();
  if (!options.truth.empty()) inputs.emplace_back(options.truth);
  check_outputs({options.json, options.report.page}, inputs);
  CorrectionModels models;
  if (arguments.retrain) {
    const WorkflowOptions workflow{options.seed, options.threads, options.quiet};
    study.set_parameters(tune_study(study, workflow));
    models = train_study(study, {}, workflow);
  }
  compare_study(study, models, options);
}

}  // namespace

void add_compare(const Subcommands& all) {
  auto arguments = std::make_shared<CompareArguments>();
  CompareStudyOptions& options = arguments->options;
  const Subcommand command = all.add("compare", "run the study's trackers on held-out runs and compare their errors");
  add_study(command, arguments->study);
  command.argument("--seed", arguments->seed, "seed; the study's own where not given");
  command.argument("--runs", options.runs, "runs; the study's own number where not given").within(1, 10000000);
  command.argument("--threads", options.threads, "0: one per core").within(0, 1024);
  command.argument("--truth", options.truth,
                   "a recorded track (log with truth, or positions), measured afresh in every run; or a line array's "
                   "log with truth, replayed");
  add_log_arguments(command, options.reading);
  command.flag("--retrain", arguments->retrain, "tune and train afresh with this seed; files are left alone");
  command.argument("--json", options.json, "write the results as JSON; - is standard output");
  add_report_arguments(command, options.report);
  add_table_arguments(command, options.tables);
  command.flag("--all", arguments->all, "with trackers that the study does not show");
  command.flag("--quiet", options.quiet, "no progress");
  command.runs([arguments] { run_compare(*arguments); });
}

}  // namespace truebearing
