// SPDX-License-Identifier: Apache-2.0
// A study: one comparison, from its TOML file. A scenario (fixed, or a family to draw from), the trackers, their
// corrections and how those are trained, and what is scored. The factory of the house: it makes what the file names.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "truebearing/correction/correction_model.hpp"
#include "truebearing/evaluation/comparison.hpp"
#include "truebearing/evaluation/tracker_set.hpp"
#include "truebearing/simulation/scenario.hpp"
#include "truebearing/study/parameters_file.hpp"
#include "truebearing/study/recorded_file.hpp"
#include "truebearing/study/study_file.hpp"
#include "truebearing/study/study_scoring.hpp"
#include "truebearing/study/tracker_spec.hpp"

namespace truebearing {

using CorrectionModels = std::map<std::string, std::shared_ptr<const CorrectionModel>>;

class Study {
 public:
  /// Reads and checks a study file, or one that comes with the program by its name; makes each tracker once. Throws InputError.
  static Study load(const std::filesystem::path& path);

  const std::string& name() const { return name_; }
  const std::filesystem::path& path() const { return path_; }
  /// Its own file, and every file that is there of those that it or its scenario names: what an output must not destroy.
  std::vector<std::filesystem::path> input_files() const;
  /// What the trackers are tuned and trained on.
  const Scenario& scenario() const { return *scenario_; }
  /// One that is made of it or of another, as its sets and what corrections are taught on may be. Throws InputError.
  std::unique_ptr<Scenario> scenario(const ChangedScenario& changed) const;
  /// What they are compared on: the same, or the sets that the study names.
  std::vector<NamedScenario> evaluation_scenarios() const;
  /// How a log that the study is given is to be read: as its table [log] says, and for what its trackers measure.
  RecordingOptions recording_options() const;
  /// A recorded track as a scenario: a measurement log with truth, or recorded positions that are measured as the
  /// study's [recorded] says; read as recording_options() says, or as is said here. The study must outlive it.
  std::unique_ptr<Scenario> recorded_scenario(const std::filesystem::path& file) const;
  std::unique_ptr<Scenario> recorded_scenario(const std::filesystem::path& file, RecordingOptions options) const;
  std::uint64_t seed() const { return seed_; }
  std::size_t runs() const { return runs_; }
  std::size_t tuning_runs() const { return tuning_runs_; }
  const ScoringRule& scoring() const { return scoring_.rule; }
  const std::vector<std::pair<std::string, std::string>>& pairs() const { return scoring_.pairs; }
  const std::vector<std::string>& bounds() const { return scoring_.bounds; }
  const std::filesystem::path& parameters_path() const { return parameters_path_; }

  const std::vector<TrackerSpec>& trackers() const { return trackers_; }
  /// Throws InputError that suggests the nearest name.
  const TrackerSpec& tracker(const std::string& name) const;

  /// The tuned parameters in place of those read from parameters_path().
  void set_parameters(ParametersFile parameters) { parameters_ = std::move(parameters); }
  /// Gives every tracker a row, also those with `show = false`.
  void show_all();
  /// Shows in place of every shown filter its smoother, NAME_smoothed, of that lag (SmootherSpec); what there is no
  /// smoother of is told of, and not shown. Pairs and bounds are dropped.
  void smooth_all(double lag_s, const std::function<void(const std::string& name)>& left_out);
  /// Whether a shown tracker wants to know a whole run before its first step.
  bool looks_back() const;
  const std::optional<ParametersFile>& parameters() const { return parameters_; }

  /// A tracker's table with its tuned numbers in it. Throws InputError where those are missing.
  SharedTable configuration_of(const std::string& name) const;
  /// The same on one line with its kind: how a model file remembers a tracker.
  std::string configuration_line(const std::string& name) const;
  /// A tracker of the study, ready to step; a corrected one brings its own ensemble, and its model from `models`, else
  /// from its file.
  std::unique_ptr<Tracker> make_tracker(const std::string& name, const CorrectionModels& models = {}) const;
  /// The trackers of those names (none of them corrected), in that order.
  Ensemble make_ensemble(const std::vector<std::string>& names) const;
  /// All shown trackers over one ensemble; models likewise.
  TrackerSet make_tracker_set(const CorrectionModels& models = {}) const;

  /// The model of a corrected tracker from its file, checked against this study. Throws InputError that names the
  /// command that makes it where it is missing or was made for other trackers or features.
  std::shared_ptr<const CorrectionModel> load_model(const std::string& name) const;
  /// Throws InputError where the model was not trained for what the study says of that tracker. What bounds a
  /// correction is the study's to say, but a gate wants the box of its model.
  void check_model(const std::string& name, const CorrectionModel& model, const std::string& where) const;

  /// Options of a comparison as the study has them. On records the limits of the scenario's family are trackers as any
  /// other, and nothing is published.
  ComparisonOptions comparison_options(bool on_records = false) const;

  /// What whoever reads the results should know of its trackers, line by line; mostly nothing.
  std::string note() const;

 private:
  Study() = default;
  void read(const StudyFile& file);
  void check_trackers();
  bool lacks_motion(const TrackerSpec& spec) const;
  void check_limit(const TrackerSpec& spec);
  void check_smoother(const TrackerSpec& spec) const;
  void check_teacher(const TrackerSpec& spec) const;
  void check_replay(const TrackerSpec& spec, const Tracker& tracker);

  std::filesystem::path path_;
  std::vector<std::filesystem::path> files_;  // that it names, as patterns
  std::string name_;
  std::unique_ptr<Scenario> scenario_;
  SharedTable scenario_table_;
  std::string scenario_file_;
  std::vector<std::pair<std::string, std::unique_ptr<Scenario>>> sets_;
  std::optional<RecordedSpec> recorded_;
  RecordingOptions log_;
  std::vector<double> clock_offsets_s_;  // of the sensors, by name; empty where all are 0
  std::uint64_t seed_ = 1;
  std::size_t runs_ = 1000;
  std::size_t tuning_runs_ = 300;
  StudyScoring scoring_;
  std::vector<PublishedRow> published_;
  std::vector<std::string> limits_;  // trackers that know the scenario's family; bounds but on records
  std::filesystem::path parameters_path_;
  std::optional<ParametersFile> parameters_;
  std::vector<TrackerSpec> trackers_;
};

}  // namespace truebearing
