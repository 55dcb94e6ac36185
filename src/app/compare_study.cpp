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

void compare_study(const Study& study, const CorrectionModels& models, const CompareStudyOptions& options) {
  const std::unique_ptr<Scenario> recorded = recorded_truth(study, options);
  const std::vector<NamedScenario> scenarios =
      recorded ? std::vector<NamedScenario>{{options.truth, recorded.get()}} : study.evaluation_scenarios();
  std::string notes = study.note();
  for (const NamedScenario& named : scenarios)
    if (const std::string note = named.scenario->note(); !note.empty()) notes += note + "\n";

  ComparisonOptions comparison_options = study.comparison_options(recorded != nullptr);
  comparison_options.seed = options.seed;
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
  const Recording timed = scenarios.front().scenario->simulate({options.seed, Role::evaluation, 0});
  for (int i = 0; i < trackers.size(); ++i)
    comparison.ns_per_step.emplace_back(trackers.name(i),
                                        time_per_step_ns(*study.make_tracker(trackers.name(i), models), timed));

  std::vector<RunPicture> pictures;
  if (options.report.wanted())
    pictures = picture_runs(trackers, scenarios, comparison_options, comparison, sensor_sites(study));
  nlohmann::ordered_json on_log;
  if (recorded && options.report.wanted())
    on_log =
        run_json(study, options.truth, trackers, *recorded, {options.seed, Role::evaluation, median_run(pictures)});
  const std::string json = comparison_json(comparison, pictures, on_log.is_null() ? nullptr : &on_log);
  const bool prints = !is_standard_output(options.json) && !is_standard_output(options.report.page);
  if (prints) fmt::print("{}{}", notes, with_best_coloured(comparison_table(comparison, options.tables.layout())));
  if (!options.json.empty()) write_output(options.json, json);
  if (comparison.trackers.empty() || !(prints || options.report.wanted())) return;
  const Results results = parse_results(json, study.name());
  if (prints) fmt::print("\n{}\n", emphasised(answer(results)));
  if (options.report.wanted()) write_report(options.report, {results});
}

}  // namespace truebearing
