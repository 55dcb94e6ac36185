// SPDX-License-Identifier: Apache-2.0
#include "app/workflow.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <system_error>

#include "app/output.hpp"
#include "app/shard.hpp"
#include "training/learned_motion_training.hpp"
#include "training/train_correction.hpp"
#include "training/tune.hpp"
#include "truebearing/correction/learned_motion_file.hpp"
#include "truebearing/correction/model_file.hpp"

namespace truebearing {
namespace {

constexpr std::size_t kValidationRuns = 200;

std::string checkpoint_of(const std::string& model) {
  return model + ".checkpoint";
}

// RMSE of the corrected tracker, its base and its reference on runs that neither training nor evaluation sees; the same
// text at all ranks.
std::string validation_scores(const Study& study, const std::string& name, const CorrectionModels& models,
                              const WorkflowOptions& options) {
  const CorrectionSpec& spec = study.tracker(name).correction.value();
  TrackerSet trackers(study.make_ensemble(spec.members()));
  trackers.show_member(spec.design.base);
  if (spec.design.reference != spec.design.base) trackers.show_member(spec.design.reference);
  trackers.show_correction(name, models.at(name), spec.bounds);
  ComparisonOptions comparison_options;
  comparison_options.seed = options.seed;
  comparison_options.role = Role::validation;
  comparison_options.runs = kValidationRuns;
  comparison_options.threads = options.threads;
  comparison_options.scoring = study.scoring();
  const std::vector<NamedScenario> scenarios{{study.name(), &study.scenario()}};
  ComparisonRuns runs(trackers, scenarios, comparison_options);
  ComparisonFigures figures(runs);
  run_blocks(runs, options.ranks, {}, [&](std::size_t block, std::string_view bytes) { figures.add(block, bytes); });
  if (!is_first(options.ranks)) return from_first(*options.ranks, {});
  const Comparison comparison = figures.comparison();
  std::string text;
  for (const TrackerSummary& summary : comparison.trackers) {
    text += fmt::format("{}{}", text.empty() ? "" : "; ", summary.name);
    for (const QuantitySummary& quantity : summary.quantities)
      text += fmt::format(" {} {:.4g} +- {:.2g}", quantity.name, quantity.rmse, quantity.rmse_se);
  }
  if (options.ranks) from_first(*options.ranks, text);
  return text;
}

bool is_tuned(const TrackerSpec& spec) {
  return !spec.tune.empty() && !spec.correction;
}

}  // namespace

bool has_tuned_trackers(const Study& study) {
  return std::any_of(study.trackers().begin(), study.trackers().end(), is_tuned);
}

std::vector<std::string> corrected_trackers(const Study& study, const std::vector<std::string>& names) {
  std::vector<std::string> corrected;
  for (const TrackerSpec& spec : study.trackers())
    if (spec.correction && (names.empty() || std::find(names.begin(), names.end(), spec.name) != names.end()))
      corrected.push_back(spec.name);
  return corrected;
}

std::vector<std::filesystem::path> inputs_without(const Study& study,
                                                  const std::vector<std::filesystem::path>& replaced) {
  std::vector<std::filesystem::path> inputs;
  for (std::filesystem::path& input : study.input_files()) {
    std::error_code unknown;
    const auto is_input = [&](const std::filesystem::path& path) {
      return std::filesystem::equivalent(path, input, unknown);
    };
    if (std::none_of(replaced.begin(), replaced.end(), is_input)) inputs.push_back(std::move(input));
  }
  return inputs;
}

void check_products(const Study& study, const std::vector<std::string>& outputs,
                    const std::vector<std::filesystem::path>& replaced) {
  check_outputs(outputs, inputs_without(study, replaced));
}

void check_ranks(Ranks* ranks, const std::vector<std::filesystem::path>& files, const std::string& options) {
  if (ranks)
    check_all_have(*ranks, fmt::format("{} {} {}", TRUEBEARING_VERSION, hash_of_files(files), options),
                   "version, other options, or another text of the study, or of a model, a scenario or a track of it,");
}

ParametersFile tune_study(const Study& study, const WorkflowOptions& options) {
  ParametersFile parameters;
  parameters.provenance = {{"study", study.name()},
                           {"seed", fmt::format("{}", options.seed)},
                           {"tuning_runs", fmt::format("{}", study.tuning_runs())}};
  for (const TrackerSpec& spec : study.trackers()) {
    if (!is_tuned(spec)) continue;
    TuneReport report;
    {
      ProgressLine progress("tune " + spec.name, options.quiet);
      TuneOptions tune_options;
      tune_options.seed = options.seed;
      tune_options.threads = options.threads;
      tune_options.ranks = options.ranks;
      tune_options.progress = [&](int done, int most, double) {
        progress.show(static_cast<std::size_t>(done), static_cast<std::size_t>(most));
      };
      parameters.trackers[spec.name] = tune_tracker(study, spec.name, tune_options, &report);
    }
    if (!options.quiet)
      say(fmt::format("tuned {}: RMSE times {:.4f} (geometric mean over the scored quantities), {} evaluations",
                      spec.name,
                      std::exp((report.cost_after - report.cost_before) /
                               static_cast<double>(study.scenario().truth_space().quantities.size())),
                      report.evaluations));
  }
  return parameters;
}

std::vector<std::string> learned_trackers(const Study& study, const std::vector<std::string>& names) {
  std::vector<std::string> learned;
  for (const TrackerSpec& spec : study.trackers())
    if (spec.learned && (names.empty() || std::find(names.begin(), names.end(), spec.name) != names.end()))
      learned.push_back(spec.name);
  return learned;
}

namespace {

// Of one process.
MotionResidual train_motion(const Study& study, const std::string& name, const WorkflowOptions& options) {
  LearnedMotionReport report;
  MotionResidual residual;
  {
    ProgressLine teacher("teach " + name, options.quiet);
    ProgressLine training("train " + name, options.quiet);
    residual = train_learned_motion(study, name,
                                    {options.seed, options.threads, teacher.callback(),
                                     [&](int done, int total, double) {
                                       training.show(static_cast<std::size_t>(done), static_cast<std::size_t>(total));
                                     }},
                                    &report);
  }
  if (!options.quiet)
    say(fmt::format(
        "taught the motion of {}: {} rules on {} steps in {:.2f} s; what a prediction misses is {:.3g} times "
        "what it was",
        name, residual.network.rules(), report.rows, report.training_seconds, report.remaining));
  return residual;
}

void write_motion(const std::string& output, const MotionResidual& residual) {
  write_output(output, learned_motion_text(residual));
  if (!is_standard_output(output)) fmt::print("written: {}\n", output);
}

}  // namespace

void train_motions(const Study& study, const std::vector<std::string>& names, const std::vector<std::string>& outputs,
                   const WorkflowOptions& options) {
  if (is_first(options.ranks))
    for (std::size_t i = 0; i < names.size(); ++i) write_motion(outputs[i], train_motion(study, names[i], options));
  if (names.empty() || !options.ranks) return;
  options.ranks->gather_all({});  // from here on all read what the first has written
  check_all_have(*options.ranks, hash_of_files(study.input_files()),
                 "learned motion, which has to be in a folder that all machines share,");
}

void keep_checkpoints(const Study& study, const std::vector<std::string>& names,
                      const std::vector<std::string>& outputs, WorkflowOptions& options) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (study.tracker(names[i]).correction->design.network != NetworkKind::recurrent) continue;
    if (is_standard_output(outputs[i]))
      throw InputError("-o", "is one stream, and the model two files", "a file's name");
    options.checkpoints[names[i]] = checkpoint_of(outputs[i]);
  }
}

CorrectionModels train_study(const Study& study, const std::vector<std::string>& names,
                             const WorkflowOptions& options) {
  CorrectionModels models;
  for (const std::string& name : corrected_trackers(study, names)) {
    TrainReport report;
    CorrectionModel model;
    {
      ProgressLine teacher("teach " + name, options.quiet);
      ProgressLine training("train " + name, options.quiet);
      TrainOptions train_options{options.seed, options.threads, teacher.callback(), [&](int done, int total, double) {
                                   training.show(static_cast<std::size_t>(done), static_cast<std::size_t>(total));
                                 }};
      train_options.ranks = options.ranks;
      if (const auto file = options.checkpoints.find(name); file != options.checkpoints.end())
        train_options.checkpoint = file->second;
      model = train_correction(study, name, train_options, &report);
    }
    CorrectionModels trained{{name, std::make_shared<const CorrectionModel>(model)}};
    model.provenance["validation"] =
        fmt::format("{} runs: {}", kValidationRuns, validation_scores(study, name, trained, options));
    if (!options.quiet)
      say(fmt::format("trained {}: {} on {} steps in {:.2f} s; validation, {}", name, describe(model.network),
                      report.rows, report.training_seconds, model.provenance["validation"]));
    models[name] = std::make_shared<const CorrectionModel>(std::move(model));
  }
  return models;
}

void write_parameters(const std::string& output, const ParametersFile& parameters) {
  write_output(output, parameters_text(parameters));
  if (!is_standard_output(output)) fmt::print("written: {}\n", output);
}

void write_model(const std::string& output, const CorrectionModel& model) {
  if (weights_name(model).empty()) {
    write_output(output, model_text(model));
  } else {
    write_model_file(output, model);
    std::error_code ignored;
    std::filesystem::remove(checkpoint_of(output), ignored);
  }
  if (!is_standard_output(output)) fmt::print("written: {}\n", output);
}

}  // namespace truebearing
