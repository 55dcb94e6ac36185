// SPDX-License-Identifier: Apache-2.0
// truebearing track STUDY.toml LOG: the study's trackers on a recorded log, row by row as it comes. With truth in the
// log, their errors; without, what can still be said: NIS and its consistency, whiteness, rejected and missing
// measurements. And what the trackers noticed beside their estimates. truebearing smooth does the same with the smoothers
// of the study's filters, once the log has ended.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/data_folder.hpp"
#include "app/log_options.hpp"
#include "app/output.hpp"
#include "app/report_output.hpp"
#include "app/subcommands.hpp"
#include "app/terminal.hpp"
#include "app/track_foretelling.hpp"
#include "app/track_output.hpp"
#include "app/track_report.hpp"
#include "app/track_run.hpp"
#include "app/track_scores.hpp"
#include "app/tracked_log.hpp"
#include "truebearing/array/recorded_array.hpp"
#include "truebearing/core/constants.hpp"
#include "truebearing/evaluation/report.hpp"
#include "truebearing/io/csv.hpp"
#include "truebearing/io/json_file.hpp"
#include "truebearing/recording/geographic_track.hpp"
#include "truebearing/recording/recording_csv.hpp"
#include "truebearing/recording/snapshot_log.hpp"
#include "truebearing/report/log_page.hpp"
#include "truebearing/study/log_fit.hpp"
#include "truebearing/study/measured_check.hpp"
#include "truebearing/study/study.hpp"
#include "truebearing/study/study_sites.hpp"
#include "truebearing/tracker/step_log.hpp"
#include "truebearing/tracker/step_log_scenario.hpp"

namespace truebearing {
namespace {

struct TrackArguments {
  std::string study;
  std::string log;
  std::string output;
  std::string json;
  std::string events;
  LogArguments reading;
  double late_s = -1.0;  // not given
  int foretold = 0;      // steps ahead; 0: nothing is
  ReportArguments report;
  bool smooth = false;
  double lag_s = kInfinity;  ///< of `smooth`

  /// What is for programs or for a page: scores where the log has truth, else what can be said without.
  bool wants_results() const { return !json.empty() || report.wanted(); }
  bool only_text_for_programs() const {
    return is_standard_output(output) || is_standard_output(json) || is_standard_output(events) ||
           is_standard_output(report.page);
  }
};

void report(const Study& study, const TrackArguments& options, const TrackRun& run, const Recording::Counts& rows) {
  const std::size_t count = run.contents().measurements;
  fmt::print("{}: {} measurement{}, {} missing, {} repeated rows dropped\n\n", options.log, count,
             count == 1 ? "" : "s", rows.missing, rows.repeated);
  fmt::print("{}", consistency_table(run.all()));
  for (const Followed& followed : run.all())
    if (followed.records == 0)
      fmt::print("{}: no track began: {}\n", followed.name, why_no_track(study, followed.name, run.contents()));
  for (const std::string& text : {estimate_table(run.all()), event_table(run.all())})
    if (!text.empty()) fmt::print("\n{}", text);
}

void say_epoch(const TrackArguments& options, double epoch_s) {
  if (epoch_s != 0.0)
    say(fmt::format("truebearing: {}: begins after all times of the study, which are counted from {:.15g} s",
                    options.log, epoch_s));
}

void write_log_results(const TrackArguments& options, const nlohmann::ordered_json& on_log,
                       const std::vector<ForetoldLog>& foretold) {
  const std::string json = with_foretelling(json_text(on_log), foretold);
  if (!options.json.empty()) write_output(options.json, json);
  if (!options.report.page.empty()) write_output(options.report.page, log_page(json, options.log));
  if (!options.report.svg.empty()) write_plots(options.report.svg, log_plot_files(json, options.log));
}

std::vector<ForetoldLog> who_foretells(const Study& study, const TrackArguments& options, const TrackRun& run,
                                       const KeptLogs& logs) {
  if (options.foretold == 0) return {};
  std::vector<ForetoldLog> all =
      foretell(run.trackers(), options.log, logs, run.contents().epoch_s, options.foretold, sensor_sites(study));
  for (const ForetoldLog& log : all) {
    const std::string of_track = logs.size() > 1 ? fmt::format("track {}\n", log.number) : "";
    const std::string text = of_track + foretelling_text(log.told);
    if (options.only_text_for_programs())
      say(text);
    else
      fmt::print("\n{}", text);
  }
  return all;
}

// logs: what is to be scored, or told of where it has no truth; empty where neither is wanted.
void finish(const Study& study, const TrackArguments& options, TrackRun& run, const Recording::Counts& rows,
            KeptLogs logs) {
  const bool for_people = !options.only_text_for_programs();
  if (for_people) report(study, options, run, rows);
  for (const std::string& line : consistency_warnings(run.all())) say("truebearing: " + line);
  const KeptLogs foretold = options.foretold > 0 ? logs : KeptLogs();
  nlohmann::ordered_json on_log;
  if (options.wants_results()) on_log = log_json(tracked_log(study, options.log, run, rows, logs), run.all());
  std::vector<Recording> tracks;
  for (auto& [number, recording] : logs)
    if (recording.truth_space) tracks.push_back(std::move(recording));
  std::optional<ScoredLog> scored;
  if (!tracks.empty())
    scored = score_log(study, options.log, run.trackers(), std::move(tracks), run.contents().epoch_s,
                       options.report.wanted());
  run.finish();
  const std::vector<ForetoldLog> told = who_foretells(study, options, run, foretold);
  if (!scored) {
    if (options.wants_results()) write_log_results(options, on_log, told);
    return;
  }
  if (for_people) fmt::print("\n{}", comparison_table(scored->comparison, TableArguments{}.layout()));
  if (!options.wants_results()) return;
  on_log.erase("picture");  // which stands beside its truth
  const std::string json = with_foretelling(
      comparison_json(scored->comparison, scored->pictures, options.report.wanted() ? &on_log : nullptr), told);
  if (!options.json.empty()) write_output(options.json, json);
  if (options.report.wanted()) write_report(options.report, {parse_results(json, options.log)});
}

void track_step_log(const Study& study, const StepLogScenario& logs, const TrackArguments& options) {
  std::vector<RecordedTrack> read = logs.read(options.log);
  const std::vector<Measurement>& first = read.front().recording.measurements;
  TrackRun run(study, options.output, options.events, static_cast<int>(first.front().z.size()));
  Recording::Counts rows;
  KeptLogs logs_kept;
  for (auto& [number, recording] : read) {
    if (read.size() > 1 || number != 0) run.begin_track(number);
    if (study.looks_back()) run.foresee(recording.measurements);
    for (const Measurement& measurement : recording.measurements) run.step(measurement);
    run.end_track(recording.counts);
    rows.missing += recording.counts.missing;
    if (recording.truth_space || options.wants_results() || options.foretold > 0)
      logs_kept.emplace_back(number, std::move(recording));
  }
  finish(study, options, run, rows, std::move(logs_kept));
}

void track_snapshots(const Study& study, const TrackArguments& options) {
  Recording recording = read_snapshot_log(options.log);
  check_measured(recording.measured, study.scenario(), options.log);
  const LineArray array = array_of(recording);
  check_measured(study, Measured::snapshots(array.sensors), options.log);
  TrackRun run(study, options.output, options.events, static_cast<int>(recording.measured.size()));
  const double epoch_s = study_epoch_s(study, recording.measurements.front().time_s);
  say_epoch(options, epoch_s);
  run.begin_at(epoch_s);
  for (const Measurement& measurement : recording.measurements) run.step(measurement);
  const Recording::Counts rows = recording.counts;
  run.end_track(rows);
  print_note(options.log, array.note());
  KeptLogs logs;
  if (recording.truth_space || options.wants_results() || options.foretold > 0)
    logs.emplace_back(0, std::move(recording));
  finish(study, options, run, rows, std::move(logs));
}

// Rows that came late, where they belong.
void sort_by_time(Recording& recording) {
  std::vector<std::size_t> order(recording.measurements.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return recording.measurements[a].time_s < recording.measurements[b].time_s;
  });
  const auto sorted = [&](const auto& unsorted) {
    auto values = unsorted;
    for (std::size_t k = 0; k < values.size(); ++k) values[k] = unsorted[order[k]];
    return values;
  };
  recording.measurements = sorted(recording.measurements);
  recording.line = sorted(recording.line);
  for (Truth& truth : recording.truth) truth.x = sorted(truth.x);
}

void track_rows(const Study& study, const TrackArguments& options) {
  RecordingOptions reading = options.reading.over(study.recording_options());
  if (options.late_s >= 0.0) reading.late_keep_s = options.late_s;
  if (study.looks_back()) {  // which waits for the end in any case
    reading.sort_window_s = std::max(reading.sort_window_s, reading.late_keep_s);
    reading.late_keep_s = 0.0;
  }
  MeasurementLog reader(open_table(options.log, reading), reading);
  check_measured(reader.measured(), study.scenario(), options.log);
  // Whoever is only given the records needs no scores, and the log has no end that could be waited for.
  const bool keeps =
      options.foretold > 0 || options.wants_results() || (reader.truth_space() && !options.only_text_for_programs());
  TrackRun run(study, options.output, options.events, static_cast<int>(reader.measured().size()), reading);
  Recording recording;
  std::vector<Measurement> all;  // where a tracker wants to know them beforehand
  for (bool first = true; reader.next(); first = false) {
    if (first) {
      const double epoch_s = study_epoch_s(study, reader.measurement().time_s);
      say_epoch(options, epoch_s);
      run.begin_at(epoch_s);
    }
    if (study.looks_back()) {
      all.push_back(reader.measurement());
      if (keeps) reader.append_to(recording);
      continue;
    }
    if (run.step(reader.measurement()) && keeps) reader.append_to(recording);
    if (reader.may_wait()) run.flush();
  }
  if (!all.empty()) run.foresee(all);
  for (const Measurement& measurement : all) run.step(measurement);
  run.end_track(reader.counts());
  print_note(options.log, reader.findings().note());
  print_note(options.log, run.late_note());
  KeptLogs logs;
  if (keeps) {
    if (reading.late_keep_s > 0.0) sort_by_time(recording);
    reader.complete(recording);
    logs.emplace_back(0, std::move(recording));
  }
  finish(study, options, run, reader.counts(), std::move(logs));
}

void smooth_all(Study& study, const TrackArguments& options) {
  study.smooth_all(options.lag_s, [](const std::string& name) {
    say(fmt::format("truebearing: {}: is left out: there is no smoother of it", name));
  });
  if (!study.looks_back())
    throw InputError(options.study, "shows no filter that there is a smoother of",
                     "a filter, an imm or a bank, without output_pull and ahead_s");
}

void track(const TrackArguments& options) {
  Study study = Study::load(options.study);
  if (options.smooth) smooth_all(study, options);
  std::vector<std::filesystem::path> inputs = study.input_files();
  inputs.emplace_back(options.log);
  check_outputs(options.report, {options.output, options.json, options.events}, inputs);
  if (const auto* logs = dynamic_cast<const StepLogScenario*>(&study.scenario()))
    return track_step_log(study, *logs, options);
  if (is_snapshot_log(options.log)) return track_snapshots(study, options);
  if (is_geographic_track(options.log))
    throw InputError(
        options.log, "holds recorded positions, which are no measurements",
        fmt::format("`truebearing compare {} --truth {}`, which measures them", options.study, options.log));
  track_rows(study, options);
}

void add_shared(const Subcommand& command, TrackArguments& options) {
  add_study(command, options.study);
  command
      .argument("log", options.log,
                "measurement log (CSV, or HDF5 of a line array), or step log where the study's scenario is of those; "
                "- is standard input")
      .required();
  command.argument("-o,--output", options.output, "write the trackers' step records as CSV; - is standard output");
  command.argument(
      "--json", options.json,
      "write the scores as JSON, or where the log has no truth what can be said without; - is standard output");
}

}  // namespace

void add_track(const Subcommands& all) {
  auto options = std::make_shared<TrackArguments>();
  const Subcommand command = all.add("track", "run the study's trackers on a recorded log");
  add_shared(command, *options);
  command.argument("--events", options->events,
                   "write what the trackers noticed (turns, a source's jumps, ...) as CSV; - is standard output");
  add_report_arguments(command, options->report);
  add_log_arguments(command, options->reading);
  command
      .argument("--late", options->late_s,
                "take rows as they come, and those that are up to so many seconds late where they belong, by running "
                "the steps after them again")
      .non_negative();
  command
      .argument("--foretell", options->foretold,
                "hold what trackers foretell of measurements that are hidden from them, so many steps ahead, against "
                "these: who is better without a truth")
      .within(0, 100000);
  command.runs([options] { track(*options); });
}

void add_smooth(const Subcommands& all) {
  auto options = std::make_shared<TrackArguments>();
  options->smooth = true;
  const Subcommand command =
      all.add("smooth", "run the study's filters over a recorded log, and look back from its end");
  add_shared(command, *options);
  command.argument("--lag", options->lag_s, "look back from so many seconds later instead (fixed lag)").positive();
  add_report_arguments(command, options->report);
  add_log_arguments(command, options->reading);
  command.runs([options] { track(*options); });
}

}  // namespace truebearing
