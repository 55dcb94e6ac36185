// SPDX-License-Identifier: Apache-2.0
#include "app/compare_study.hpp"

#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <utility>

#include "app/output.hpp"
#include "app/tracked_log.hpp"
#include "truebearing/array/recorded_array.hpp"
#include "truebearing/evaluation/report.hpp"
#include "truebearing/recording/snapshot_log.hpp"
#include "truebearing/report/verdict.hpp"
#include "truebearing/study/measured_check.hpp"
#include "truebearing/study/study_sites.hpp"

namespace truebearing {
namespace {

std::unique_ptr<Scenario> recorded_truth(const Study& study, const CompareStudyOptions& options) {
  if (options.truth.empty()) return nullptr;
  auto recorded = study.recorded_scenario(options.truth, options.reading.over(study.recording_options()));
  if (is_snapshot_log(options.truth))
    check_measured(study,
                   Measured::snapshots(array_of(recorded->simulate({options.seed, Role::evaluation, 0})).sensors),
                   options.truth);
  return recorded;
}

// The run between the better and the worse half; the first where none was drawn.
std::size_t median_run(const std::vector<RunPicture>& pictures) {
  for (const RunPicture& picture : pictures)
    if (picture.which == "median") return picture.run;
  return 0;
}

}  // namespace

StudyComparison::StudyComparison(const Study& study, const CorrectionModels& models, const CompareStudyOptions& options)
    : study_(study),
      models_(models),
      asked_(options),
      recorded_(recorded_truth(study, options)),
      scenarios_(recorded_ ? std::vector<NamedScenario>{{options.truth, recorded_.get()}}
                           : study.evaluation_scenarios()),
      notes_(study.note()),
      comparison_options_(study.comparison_options(recorded_ != nullptr)),
      trackers_(study.make_tracker_set(models)) {
  for (const NamedScenario& named : scenarios_)
    if (const std::string note = named.scenario->note(); !note.empty()) notes_ += note + "\n";
  comparison_options_.seed = options.seed;
  if (options.runs > 0) comparison_options_.runs = options.runs;
  comparison_options_.threads = options.threads;
  comparison_options_.details = options.details || options.report.wanted();
  runs_ = std::make_unique<ComparisonRuns>(trackers_, scenarios_, comparison_options_);
  const std::size_t asked = std::exchange(comparison_options_.runs, runs_->options().runs);
  if (comparison_options_.runs < asked)
    notes_ += fmt::format("runs: {} in place of {}, which would be the same again\n", comparison_options_.runs, asked);
}

// Why nothing is scored, where no step is late enough for it; else empty.
std::string StudyComparison::not_scored(const Recording& first) const {
  const auto steps = first.measurements.size();
  const int from = comparison_options_.scoring.from_step;
  if (static_cast<std::size_t>(from) <= steps) return {};
  return fmt::format(" It is scored from step {} on, and the first run has {}.", from, steps);
}

void StudyComparison::write(Comparison comparison) const {
  comparison.study = study_.name();
  const Recording timed = scenarios_.front().scenario->simulate({asked_.seed, Role::evaluation, 0});
  for (int i = 0; i < trackers_.size(); ++i)
    comparison.ns_per_step.emplace_back(trackers_.name(i),
                                        time_per_step_ns(*study_.make_tracker(trackers_.name(i), models_), timed));

  std::vector<RunPicture> pictures;
  if (asked_.report.wanted())
    pictures = picture_runs(trackers_, scenarios_, comparison_options_, comparison, sensor_sites(study_));
  nlohmann::ordered_json on_log;
  if (recorded_ && asked_.report.wanted())
    on_log =
        run_json(study_, asked_.truth, trackers_, *recorded_, {asked_.seed, Role::evaluation, median_run(pictures)});
  const std::string json = comparison_json(comparison, pictures, on_log.is_null() ? nullptr : &on_log);
  const bool prints = !is_standard_output(asked_.json) && !is_standard_output(asked_.report.page);
  if (prints) fmt::print("{}{}", notes_, with_best_coloured(comparison_table(comparison, asked_.tables.layout())));
  if (!asked_.json.empty()) write_output(asked_.json, json);
  if (comparison.trackers.empty() || !(prints || asked_.report.wanted())) return;
  const Results results = parse_results(json, study_.name());
  if (prints) fmt::print("\n{}{}\n", emphasised(answer(results)), not_scored(timed));
  if (asked_.report.wanted()) write_report(asked_.report, {results});
}

void compare_study(const Study& study, const CorrectionModels& models, const CompareStudyOptions& options,
                   Ranks* ranks) {
  StudyComparison comparison(study, models, options);
  ComparisonFigures figures(comparison.runs());
  const auto add = [&](std::size_t block, std::string_view bytes) { figures.add(block, bytes); };
  {
    ProgressLine progress("compare", options.quiet);
    run_blocks(comparison.runs(), ranks, progress.callback(), add);
  }
  if (is_first(ranks)) comparison.write(figures.comparison());
}

}  // namespace truebearing
