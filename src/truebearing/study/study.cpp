// SPDX-License-Identifier: Apache-2.0
#include "truebearing/study/study.hpp"

#include <algorithm>
#include <toml++/toml.h>

#include "truebearing/evaluation/comparison_runs.hpp"
#include "truebearing/io/file.hpp"
#include "truebearing/study/configuration_text.hpp"
#include "truebearing/study/published_rows.hpp"
#include "truebearing/study/shipped_file.hpp"
#include "truebearing/tracker/step_log_scenario.hpp"

namespace truebearing {
namespace {

// Kinds of scenario that need more of the house than a simulator.
const ScenarioKinds kMoreScenarios{{"step_logs", read_step_log_scenario}};

// Texts in a table may name files, which lie relative to its own.
void add_texts(const toml::node& node, const std::filesystem::path& folder, std::vector<std::filesystem::path>& files) {
  if (const auto* text = node.as_string()) files.push_back(folder / text->get());
  if (const auto* array = node.as_array())
    for (const toml::node& element : *array) add_texts(element, folder, files);
  if (const auto* table = node.as_table())
    for (const auto& [key, value] : *table) add_texts(value, folder, files);
}

// [sensors.NAME] clock_offset_s, in the order of their names; empty where all clocks agree. What is no number is
// refused where a tracker reads the table.
std::vector<double> clock_offsets_of(const toml::table* sensors) {
  std::vector<double> offsets;
  if (!sensors) return offsets;
  for (const auto& [name, sensor] : *sensors)  // a table's keys are in order
    if (const toml::table* one = sensor.as_table()) offsets.push_back((*one)["clock_offset_s"].value_or(0.0));
  if (std::all_of(offsets.begin(), offsets.end(), [](double offset) { return offset == 0.0; })) offsets.clear();
  return offsets;
}

}  // namespace

Study Study::load(const std::filesystem::path& path) {
  Study study;
  study.path_ = named_or_shipped(path.string(), "studies");
  study.read(read_study_file(study.path_));
  return study;
}

void Study::read(const StudyFile& file) {
  TableReader reader(file.table, path_.string());
  for (const char* elsewhere : {"like", "trackers"}) reader.node(elsewhere);
  static_cast<void>(reader.table_if_present("sensors"));  // which trackers read
  name_ = reader.text("name");
  check_name(reader, "name", name_);
  const toml::node* scenario = reader.node("scenario");
  const bool is_inside = scenario && scenario->is_table();
  scenario_file_ = is_inside ? path_.string() : reader.resolve(reader.text("scenario")).string();
  scenario_table_ = is_inside ? reader.table("scenario").raw() : read_toml_file(scenario_file_);
  scenario_ = read_scenario(TableReader(scenario_table_, scenario_file_, is_inside ? "scenario" : ""), kMoreScenarios);
  clock_offsets_s_ = clock_offsets_of((*file.table)["sensors"].as_table());
  if (auto recorded = reader.table_if_present("recorded")) recorded_ = read_recorded_spec(std::move(*recorded));
  if (auto log = reader.table_if_present("log")) log_ = read_log_table(std::move(*log));
  if (auto sets = reader.table_if_present("sets"))
    for (const std::string& set : sets->keys()) {
      check_name(*sets, set, set);
      const ChangedScenario changed = read_changed_scenario(*sets, set);
      sets_.emplace_back(set, this->scenario(changed));
      if (changed.is_recorded()) continue;  // read when it is needed
      if (sets_.back().second->truth_space() != scenario_->truth_space())
        throw sets->error(set, "has another truth than the study's scenario");
    }
  seed_ = static_cast<std::uint64_t>(reader.integer_or("seed", 1, 0, std::numeric_limits<std::int64_t>::max()));
  runs_ = static_cast<std::size_t>(reader.integer_or("runs", 1000, 1, kMostRuns));
  if (reader.has("parameters")) {
    parameters_path_ = reader.resolve(reader.text("parameters"));
    if (std::filesystem::exists(parameters_path_)) parameters_ = read_parameters_file(parameters_path_);
  }
  if (auto tuning = reader.table_if_present("tuning")) {
    tuning_runs_ = static_cast<std::size_t>(tuning->integer_or("runs", 300, 1, 1000000));
    tuning->finish();
  }
  trackers_ = read_tracker_specs(file, path_.string());
  if (auto scoring = reader.table_if_present("scoring")) {
    std::vector<NamedScenario> compared;
    if (sets_.empty()) compared.push_back({"the scenario", scenario_.get()});
    for (const auto& [set, set_scenario] : sets_) compared.push_back({"the set \"" + set + "\"", set_scenario.get()});
    scoring_ = read_study_scoring(std::move(*scoring), names_of(trackers_), scenario_->truth_space(), compared);
  }
  std::vector<std::string> set_names;
  for (const auto& [set, set_scenario] : sets_) set_names.push_back(set);
  published_ = read_published(reader, scoring_.rule, scenario_->truth_space(), set_names);
  reader.finish();
  files_ = {path_, scenario_file_};
  add_texts(*file.table, path_.parent_path(), files_);
  add_texts(*scenario_table_, std::filesystem::path(scenario_file_).parent_path(), files_);
  check_trackers();
}

std::vector<std::filesystem::path> Study::input_files() const {
  std::vector<std::filesystem::path> files;
  std::error_code unknown;
  for (const std::filesystem::path& pattern : files_) {
    if (pattern.filename().string().find('*') == std::string::npos) {
      if (std::filesystem::exists(pattern, unknown)) files.push_back(pattern);
      continue;
    }
    try {
      for (std::filesystem::path& file : matching_files(pattern)) files.push_back(std::move(file));
    } catch (const InputError&) {  // nothing is there to be destroyed
    }
  }
  return files;
}

std::vector<NamedScenario> Study::evaluation_scenarios() const {
  if (sets_.empty()) return {{name_, scenario_.get()}};
  std::vector<NamedScenario> scenarios;
  for (const auto& [name, scenario] : sets_) {
    if (scenario->truth_space() != scenario_->truth_space())  // of a recorded track, known only now
      throw InputError(path_.string() + ": sets." + name, "has another truth than the study's scenario");
    scenarios.push_back({name, scenario.get()});
  }
  return scenarios;
}

std::unique_ptr<Scenario> Study::scenario(const ChangedScenario& changed) const {
  if (changed.is_recorded()) return recorded_scenario(changed.file);
  const SharedTable original = changed.file.empty() ? scenario_table_ : read_toml_file(changed.file);
  const auto table = std::make_shared<const toml::table>(merged(*original, *changed.changes));
  return read_scenario(TableReader(table, changed.file.empty() ? scenario_file_ : changed.file.string()),
                       kMoreScenarios);
}

RecordingOptions Study::recording_options() const {
  RecordingOptions options = log_;
  if (const std::optional<Measured> measured = scenario_->measured(); measured && !measured->is_step_log()) {
    options.measured = measured->components;
    options.sources = measured->sources;
    if (clock_offsets_s_.size() == measured->sources.size()) options.clock_offsets_s = clock_offsets_s_;
  }
  return options;
}

std::unique_ptr<Scenario> Study::recorded_scenario(const std::filesystem::path& file) const {
  return recorded_scenario(file, recording_options());
}

std::unique_ptr<Scenario> Study::recorded_scenario(const std::filesystem::path& file, RecordingOptions options) const {
  return std::make_unique<RecordedFile>(file, recorded_, *scenario_, path_, std::move(options));
}

ComparisonOptions Study::comparison_options(bool on_records) const {
  ComparisonOptions options;
  options.seed = seed_;
  options.runs = runs_;
  options.scoring = scoring_.rule;
  options.pairs = scoring_.pairs;
  for (const std::string& bound : scoring_.bounds)
    if (!on_records || std::find(limits_.begin(), limits_.end(), bound) == limits_.end())
      options.bounds.push_back(bound);
  if (!on_records) options.published = published_;
  options.cramer_rao = scoring_.timed.cramer_rao;
  options.angle_bound = scoring_.angle_bound;
  options.global_minimum = scoring_.timed.global_minimum;
  return options;
}

}  // namespace truebearing
