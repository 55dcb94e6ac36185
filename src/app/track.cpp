// truebearing track STUDY.toml LOG.csv: the study's trackers on a recorded log. With truth in the log, their errors;
// without, what can still be said: NIS and its consistency, whiteness, rejected and missing measurements.
#include <algorithm>
#include <fmt/format.h>
#include <map>
#include <memory>

#include "app/output.hpp"
#include "app/subcommands.hpp"
#include "truebearing/evaluation/innovation_consistency.hpp"
#include "truebearing/evaluation/report.hpp"
#include "truebearing/measurement/recording_csv.hpp"
#include "truebearing/study/study.hpp"
#include "truebearing/tracker/step_log.hpp"

namespace truebearing {
namespace {

struct Options {
  std::string study;
  std::string log;
  std::string output;
  std::string json;
};

void check_columns(const Study& study, const Recording& recording, const std::string& log) {
  const std::vector<std::string> wanted = study.scenario().simulate({study.seed(), Role::evaluation, 0}).measured;
  const auto joined = [](const std::vector<std::string>& names) { return fmt::format("{}", fmt::join(names, ", ")); };
  if (recording.measured != wanted)
    throw InputError(log, "measures " + joined(recording.measured),
                     joined(wanted) + ", which the study's trackers take");
}

// Writes the records of all trackers whose state is the first corrected or plain one's.
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
    if (!writer_) writer_.emplace(*space_, record.innovation ? static_cast<int>(record.innovation->nu.size()) : 1);
    writer_->add(name, record);
  }
  std::string str() const { return writer_ ? writer_->str() : StepLogWriter(*space_, 1).str(); }

 private:
  const StateSpace* space_;
  std::optional<StepLogWriter> writer_;
};

void print_consistency(const TrackerSet& trackers, const std::vector<InnovationConsistency>& consistency) {
  fmt::print("{:<14}{:>8}{:>24}{:>22}{:>9}{:>9}{:>9}{:>8}\n", "tracker", "steps", "NIS/expected (95 %)",
             "correlation (95 %)", "missing", "repeated", "gated", "failed");
  for (int i = 0; i < trackers.size(); ++i) {
    const InnovationConsistency& c = consistency[static_cast<std::size_t>(i)];
    const TrackerCounts counts = trackers.counts(i);
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

// The log's own measurements as the one run of a comparison.
class LogScenario final : public Scenario {
 public:
  explicit LogScenario(const Recording& recording) : recording_(recording) {}
  Recording simulate(const RunKey&) const override { return recording_; }
  const StateSpace& truth_space() const override { return *recording_.truth_space; }

 private:
  const Recording& recording_;
};

void track(const Options& options) {
  const Study study = Study::load(options.study);
  const Recording recording = read_recording(options.log);
  check_columns(study, recording, options.log);
  TrackerSet trackers = study.make_tracker_set();

  TrackWriter writer(trackers);
  std::vector<InnovationConsistency> consistency(static_cast<std::size_t>(trackers.size()));
  for (const Measurement& measurement : recording.measurements) {
    trackers.step(measurement);
    for (int i = 0; i < trackers.size(); ++i)
      for (const StepRecord& record : trackers.records(i)) {
        if (!record.correction)
          consistency[static_cast<std::size_t>(i)].add(record);  // a correction has no innovations
        writer.add(trackers.name(i), record);
      }
  }
  const bool to_stdout = options.output == "-" || options.json == "-";
  if (!to_stdout) {
    fmt::print("{}: {} measurements, {} missing, {} repeated rows dropped\n\n", options.log,
               recording.measurements.size(), recording.counts.missing, recording.counts.repeated);
    print_consistency(trackers, consistency);
  }
  if (recording.truth_space) {
    ComparisonOptions comparison_options = study.comparison_options();
    comparison_options.runs = 1;
    comparison_options.threads = 1;
    const LogScenario scenario(recording);
    Comparison comparison = compare(trackers, {{options.log, &scenario}}, comparison_options);
    comparison.study = study.name() + " on " + options.log;
    if (!to_stdout) fmt::print("\n{}", comparison_table(comparison));
    if (!options.json.empty()) write_output(options.json, comparison_json(comparison));
  } else if (!options.json.empty()) {
    throw InputError(options.log, "has no truth to score against", "columns truth_<component>, or no --json");
  }
  if (!options.output.empty()) write_output(options.output, writer.str());
}

}  // namespace

void add_track(CLI::App& app) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("track", "run the study's trackers on a recorded log");
  command->add_option("study", options->study, "study file (TOML)")->required();
  command->add_option("log", options->log, "measurement log (CSV); - is standard input")->required();
  command->add_option("-o,--output", options->output, "write the trackers' step records as CSV; - is standard output");
  command->add_option("--json", options->json,
                      "write the scores as JSON, where the log has truth; - is standard output");
  command->callback([options] { track(*options); });
}

}  // namespace truebearing
