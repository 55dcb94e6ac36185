// SPDX-License-Identifier: Apache-2.0
// truebearing compare STUDY.toml: the study's trackers on Monte Carlo runs, scored against the truth.
#include <cstdint>
#include <filesystem>
#include <fmt/format.h>
#include <memory>
#include <optional>
#include <vector>

#include "app/data_folder.hpp"
#include "app/log_options.hpp"
#include "app/output.hpp"
#include "app/report_output.hpp"
#include "app/subcommands.hpp"
#include "app/workflow.hpp"
#include "truebearing/array/recorded_array.hpp"
#include "truebearing/evaluation/report.hpp"
#include "truebearing/recording/snapshot_log.hpp"
#include "truebearing/study/measured_check.hpp"

namespace truebearing {
namespace {

struct CompareArguments {
  std::string study;
  std::string json;
  std::string truth;
  LogArguments reading;
  ReportArguments report;
  std::optional<std::uint64_t> seed;
  std::size_t runs = 0;
  int threads = 0;
  bool retrain = false;
  bool quiet = false;
};

void run_compare(const CompareArguments& options) {
  Study study = Study::load(options.study);
  std::vector<std::filesystem::path> inputs = study.input_files();
  if (!options.truth.empty()) inputs.emplace_back(options.truth);
  check_outputs({options.json, options.report.page}, inputs);
  const std::uint64_t seed = options.seed.value_or(study.seed());
  CorrectionModels models;
  if (options.retrain) {
    const WorkflowOptions workflow{seed, options.threads, options.quiet};
    study.set_parameters(tune_study(study, workflow));
    models = train_study(study, {}, workflow);
  }
  std::unique_ptr<Scenario> recorded;
  if (!options.truth.empty()) {
    recorded = study.recorded_scenario(options.truth, options.reading.over(study.recording_options()));
    if (is_snapshot_log(options.truth))
      check_measured(study, Measured::snapshots(array_of(recorded->simulate({seed, Role::evaluation, 0})).sensors),
                     options.truth);
  }
  const std::vector<NamedScenario> scenarios =
      recorded ? std::vector<NamedScenario>{{options.truth, recorded.get()}} : study.evaluation_scenarios();
  std::string notes = study.note();
  for (const NamedScenario& named : scenarios)
    if (const std::string note = named.scenario->note(); !note.empty()) notes += note + "\n";

  ComparisonOptions comparison_options = study.comparison_options(recorded != nullptr);
  comparison_options.seed = seed;
  if (options.runs > 0) comparison_options.runs = options.runs;
  comparison_options.threads = options.threads;
  comparison_options.details = options.report.wanted();
  const TrackerSet trackers = study.make_tracker_set(models);
  Comparison comparison;
  {
    ProgressLine progress("compare", options.quiet);
    comparison_options.progress = progress.callback();
    comparison = compare(trackers, scenarios, comparison_options);
  }
  comparison.study = study.name();
  const Recording timed = scenarios.front().scenario->simulate({seed, Role::evaluation, 0});
  for (int i = 0; i < trackers.size(); ++i)
    comparison.ns_per_step.emplace_back(trackers.name(i),
                                        time_per_step_ns(*study.make_tracker(trackers.name(i), models), timed));

  if (!is_standard_output(options.json) && !is_standard_output(options.report.page))
    fmt::print("{}{}", notes, comparison_table(comparison));
  std::vector<RunPicture> pictures;
  if (options.report.wanted()) pictures = picture_runs(trackers, scenarios, comparison_options, comparison);
  if (options.json.empty() && !options.report.wanted()) return;
  const std::string json = comparison_json(comparison, pictures);
  if (!options.json.empty()) write_output(options.json, json);
  if (options.report.wanted()) write_report(options.report, {parse_results(json, study.name())});
}

}  // namespace

void add_compare(const Subcommands& all) {
  auto options = std::make_shared<CompareArguments>();
  const Subcommand command = all.add("compare", "run the study's trackers on held-out runs and compare their errors");
  add_study(command, options->study);
  command.argument("--seed", options->seed, "seed; the study's own where not given");
  command.argument("--runs", options->runs, "runs; the study's own number where not given").within(1, 10000000);
  command.argument("--threads", options->threads, "0: one per core").within(0, 1024);
  command.argument("--truth", options->truth,
                   "a recorded track (log with truth, or positions), measured afresh in every run; or a line array's "
                   "log with truth, replayed");
  add_log_arguments(command, options->reading);
  command.flag("--retrain", options->retrain, "tune and train afresh with this seed; files are left alone");
  command.argument("--json", options->json, "write the results as JSON; - is standard output");
  add_report_arguments(command, options->report);
  command.flag("--quiet", options->quiet, "no progress");
  command.runs([options] { run_compare(*options); });
}

}  // namespace truebearing
