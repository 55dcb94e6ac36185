// truebearing track STUDY.toml LOG: the study's trackers on a recorded log. With truth in the log, their errors;
// without, what can still be said: NIS and its consistency, whiteness, rejected and missing measurements. And what the
// trackers noticed beside their estimates.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "app/output.hpp"
#include "app/subcommands.hpp"
#include "truebearing/evaluation/innovation_consistency.hpp"
#include "truebearing/evaluation/report.hpp"
#include "truebearing/evaluation/text_table.hpp"
#include "truebearing/io/csv.hpp"
#include "truebearing/recording/geographic_track.hpp"
#include "truebearing/recording/recording_csv.hpp"
#include "truebearing/recording/snapshot_log.hpp"
#include "truebearing/study/measured_check.hpp"
#include "truebearing/study/study.hpp"
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
};

// One recording, or one for each track of a step log. Of several targets of a line array there is one recording.
std::vector<RecordedTrack> read_log(const Study& study, const std::string& log) {
  if (const auto* logs = dynamic_cast<const StepLogScenario*>(&study.scenario())) return logs->read(log);
  const bool snapshots = is_snapshot_log(log);
  if (!snapshots && is_geographic_track(log))
    throw InputError(
        log, "holds recorded positions, which are no measurements",
        fmt::format("`truebearing compare {} --truth {}`, which measures them", study.path().string(), log));
  Recording recording = snapshots ? read_snapshot_log(log) : read_recording(log);
  check_measured(recording.measured, study.scenario(), log);
  return {{0, std::move(recording)}};
}

// Writes the records of all trackers whose state is the largest.
class TrackWriter {
 public:
  explicit TrackWriter(const TrackerSet& trackers) {
    int widest = 0;
    for (int i = 1; i < trackers.size(); ++i)
      if (trackers.space(i).size() > trackers.space(widest).size()) widest = i;
    space_ = &trackers.space(widest);
  }

  void add(const std::string& name, const StepRecord& record) {
    if (record.space != space_) return;
    // The first records of a track, and all of a corrected one, have no innovation.
    if (measurements_ == 0 && record.innovation) measurements_ = static_cast<int>(record.innovation->nu.size());
    rows_.emplace_back(name, record);
  }

  std::string text(bool sorted_by_time) const {
    StepLogWriter writer(*space_, std::max(measurements_, 1));
    for (const auto& [name, record] : rows_) writer.add(name, record);
    if (sorted_by_time) writer.sort_by_time();
    return writer.str();
  }

 private:
  const StateSpace* space_;
  int measurements_ = 0;  // in an innovation
  std::vector<std::pair<std::string, StepRecord>> rows_;
};

void print_consistency(const TrackerSet& trackers, const std::vector<InnovationConsistency>& consistency,
                       const std::vector<TrackerCounts>& all_counts) {
  fmt::print("{:<14}{:>8}{:>24}{:>22}{:>9}{:>9}{:>9}{:>8}\n", "tracker", "steps", "NIS/expected (95 %)",
             "correlation (95 %)", "missing", "repeated", "gated", "failed");
  for (int i = 0; i < trackers.size(); ++i) {
    const InnovationConsistency& c = consistency[static_cast<std::size_t>(i)];
    const TrackerCounts& counts = all_counts[static_cast<std::size_t>(i)];
    const std::string nis =
        c.steps() == 0 ? "-"
                       : fmt::format("{:.2f} ({:.2f}-{:.2f})", c.nis_ratio(), c.nis_ratio_low(), c.nis_ratio_high());
    const std::string correlation =
        c.steps() < 2 ? "-" : fmt::format("{:+.3f} (+-{:.3f})", c.correlation(), c.correlation_limit());
    fmt::print("{:<14}{:>8}{:>24}{:>22}{:>9}{:>9}{:>9}{:>8}\n", trackers.name(i), c.steps(), nis, correlation,
               counts.missing, counts.repeated, counts.gated, counts.failed);
  }
  for (int i = 0; i < trackers.size(); ++i)
    if (consistency[static_cast<std::size_t>(i)].is_implausible_at_start())
      fmt::print(
          stderr,
          "truebearing: {}: the first innovations are far from the size that it claims: is a column in another unit?\n",
          trackers.name(i));
}

// What each tracker noticed, track by track.
class EventLog {
 public:
  void add(const std::string& tracker, std::span<const TrackEvent> events) {
    for (const TrackEvent& event : events) lines_.push_back({tracker, event});
  }
  bool empty() const { return lines_.empty(); }

  std::string table() const {
    std::vector<std::vector<std::string>> rows{{"tracker", "time s", "event", "value"}};
    for (const auto& [tracker, event] : lines_)
      rows.push_back({tracker, fmt::format("{:g}", event.time_s), std::string(to_string(event.kind)),
                      std::isfinite(event.value) ? fmt::format("{:g}", event.value) : ""});
    return aligned(rows);
  }

  std::string csv() const {
    CsvWriter csv({"tracker", "time_s", "event", "value"});
    for (const auto& [tracker, event] : lines_) {
      csv.text(tracker);
      csv.number(event.time_s);
      csv.text(std::string(to_string(event.kind)));
      csv.number(event.value);
      csv.end_row();
    }
    return csv.str();
  }

 private:
  struct Line {
    std::string tracker;
    TrackEvent event;
  };
  std::vector<Line> lines_;
};

// The log's own measurements as the runs of a comparison, one per track.
class LogScenario final : public Scenario {
 public:
  explicit LogScenario(const std::vector<RecordedTrack>& tracks) : tracks_(tracks) {}
  Recording simulate(const RunKey& key) const override { return tracks_[static_cast<std::size_t>(key.run)].recording; }
  const StateSpace& truth_space() const override { return *tracks_.front().recording.truth_space; }

 private:
  const std::vector<RecordedTrack>& tracks_;
};

void add(TrackerCounts& sum, const TrackerCounts& counts) {
  sum.missing += counts.missing;
  sum.repeated += counts.repeated;
  sum.out_of_order += counts.out_of_order;
  sum.gated += counts.gated;
  sum.failed += counts.failed;
}

void track(const TrackArguments& options) {
  const Study study = Study::load(options.study);
  const std::vector<RecordedTrack> tracks = read_log(study, options.log);
  TrackerSet trackers = study.make_tracker_set();

  TrackWriter writer(trackers);
  const auto entries = static_cast<std::size_t>(trackers.size());
  std::vector<InnovationConsistency> consistency(entries);
  std::vector<TrackerCounts> counts(entries);
  EventLog events;
  Recording::Counts rows;
  std::size_t measurements = 0;
  for (const auto& [number, recording] : tracks) {
    trackers.reset();
    for (const Measurement& measurement : recording.measurements) {
      trackers.step(measurement);
      for (int i = 0; i < trackers.size(); ++i)
        for (StepRecord record : trackers.records(i)) {
          record.track += number;  // those of a step log are numbered 0 while they run
          consistency[static_cast<std::size_t>(i)].add(record);
          writer.add(trackers.name(i), record);
        }
    }
    for (int i = 0; i < trackers.size(); ++i) {
      add(counts[static_cast<std::size_t>(i)], trackers.counts(i));
      events.add(trackers.name(i), trackers.events(i));
    }
    measurements += recording.measurements.size();
    rows.missing += recording.counts.missing;
    rows.repeated += recording.counts.repeated;
  }
  const bool to_stdout = options.output == "-" || options.json == "-" || options.events == "-";
  if (!to_stdout) {
    fmt::print("{}: {} measurements, {} missing, {} repeated rows dropped\n\n", options.log, measurements, rows.missing,
               rows.repeated);
    print_consistency(trackers, consistency, counts);
    if (!events.empty()) fmt::print("\n{}", events.table());
  }
  if (tracks.front().recording.truth_space) {
    ComparisonOptions comparison_options = study.comparison_options();
    comparison_options.runs = tracks.size();
    comparison_options.threads = 1;
    const LogScenario scenario(tracks);
    Comparison comparison = compare(trackers, {{options.log, &scenario}}, comparison_options);
    comparison.study = study.name() + " on " + options.log;
    if (!to_stdout) fmt::print("\n{}", comparison_table(comparison));
    if (!options.json.empty()) write_output(options.json, comparison_json(comparison));
  } else if (!options.json.empty()) {
    throw InputError(options.log, "has no truth to score against", "a log with truth, or no --json");
  }
  if (!options.output.empty()) write_output(options.output, writer.text(tracks.size() > 1));
  if (!options.events.empty()) write_output(options.events, events.csv());
}

}  // namespace

void add_track(const Subcommands& all) {
  auto options = std::make_shared<TrackArguments>();
  const Subcommand command = all.add("track", "run the study's trackers on a recorded log");
  command.argument("study", options->study, "study file (TOML)").required();
  command
      .argument("log", options->log,
                "measurement log (CSV, or HDF5 of a line array), or step log where the study's scenario is of those; "
                "- is standard input")
      .required();
  command.argument("-o,--output", options->output, "write the trackers' step records as CSV; - is standard output");
  command.argument("--json", options->json, "write the scores as JSON, where the log has truth; - is standard output");
  command.argument("--events", options->events,
                   "write what the trackers noticed (turns, a source's jumps, ...) as CSV; - is standard output");
  command.runs([options] { track(*options); });
}

}  // namespace truebearing
