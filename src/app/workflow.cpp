#include "app/workflow.hpp"

#include <cmath>
#include <fmt/format.h>

#include "app/output.hpp"
#include "training/train_correction.hpp"
#include "training/tune.hpp"

namespace truebearing {
namespace {

constexpr std::size_t kValidationRuns = 200;

// RMSE of the corrected tracker, its base and its reference on runs that neither training nor evaluation sees.
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
  const Comparison comparison = compare(trackers, {{study.name(), &study.scenario()}}, comparison_options);
  std::string text;
  for (const TrackerSummary& summary : comparison.trackers) {
    text += fmt::format("{}{}", text.empty() ? "" : "; ", summary.name);
    for (const QuantitySummary& quantity : summary.quantities)
      text += fmt::format(" {} {:.4g} +- {:.2g}", quantity.name, quantity.rmse, quantity.rmse_se);
  }
  return text;
}

}  // namespace

ParametersFile tune_study(const Study& study, const WorkflowOptions& options) {
  ParametersFile parameters;
  parameters.provenance = {{"study", study.name()},
                           {"seed", fmt::format("{}", options.seed)},
                           {"tuning_runs", fmt::format("{}", study.tuning_runs())}};
  for (const TrackerSpec& spec : study.trackers()) {
    if (spec.tune.empty() || spec.correction) continue;
    ProgressLine progress("tune " + spec.name, options.quiet);
    TuneOptions tune_options;
    tune_options.seed = options.seed;
    tune_options.threads = options.threads;
    tune_options.progress = [&](int done, int most, double) {
      progress.show(static_cast<std::size_t>(done), static_cast<std::size_t>(most));
    };
    TuneReport report;
    parameters.trackers[spec.name] = tune_tracker(study, spec.name, tune_options, &report);
    if (!options.quiet)
      fmt::print(stderr, "tuned {}: RMSE times {:.4f} (geometric mean over the scored quantities), {} evaluations\n",
                 spec.name,
                 std::exp((report.cost_after - report.cost_before) /
                          static_cast<double>(study.scenario().truth_space().quantities.size())),
                 report.evaluations);
  }
  return parameters;
}

CorrectionModels train_study(const Study& study, const std::vector<std::string>& names,
                             const WorkflowOptions& options) {
  CorrectionModels models;
  for (const TrackerSpec& spec : study.trackers()) {
    if (!spec.correction) continue;
    if (!names.empty() && std::find(names.begin(), names.end(), spec.name) == names.end()) continue;
    TrainReport report;
    CorrectionModel model;
    {
      ProgressLine teacher("teach " + spec.name, options.quiet);
      ProgressLine training("train " + spec.name, options.quiet);
      TrainOptions train_options{options.seed, options.threads, teacher.callback(), [&](int done, int total, double) {
                                   training.show(static_cast<std::size_t>(done), static_cast<std::size_t>(total));
                                 }};
      model = train_correction(study, spec.name, train_options, &report);
    }
    CorrectionModels trained{{spec.name, std::make_shared<const CorrectionModel>(model)}};
    model.provenance["validation"] =
        fmt::format("{} runs: {}", kValidationRuns, validation_scores(study, spec.name, trained, options));
    if (!options.quiet)
      fmt::print(stderr, "trained {}: {} rules on {} steps in {:.2f} s; validation, {}\n", spec.name,
                 model.network.rules(), report.rows, report.training_seconds, model.provenance["validation"]);
    models[spec.name] = std::make_shared<const CorrectionModel>(std::move(model));
  }
  return models;
}

}  // namespace truebearing
