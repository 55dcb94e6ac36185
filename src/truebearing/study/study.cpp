#include "truebearing/study/study.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <set>

#include "truebearing/core/suggestion.hpp"
#include "truebearing/correction/corrected_tracker.hpp"
#include "truebearing/correction/model_file.hpp"
#include "truebearing/evaluation/metric_registry.hpp"
#include "truebearing/simulation/line_array_scenario.hpp"
#include "truebearing/study/angle_bound_scoring.hpp"
#include "truebearing/study/configuration_text.hpp"
#include "truebearing/study/tracker_registry.hpp"
#include "truebearing/tracker/recorded_tracker.hpp"
#include "truebearing/tracker/step_log_scenario.hpp"

namespace truebearing {
namespace {

// Kinds of scenario that need more of the house than a simulator.
const ScenarioKinds kMoreScenarios{{"step_logs", read_step_log_scenario}};

// Keys of a tracker's table that belong to the study, not to the maker of the tracker.
constexpr const char* kStudyKeys[] = {"kind", "like", "tune", "show"};

// A tracker's table over the tables of those it is `like`, however long the chain.
toml::table resolved(TableReader& trackers, const std::string& name, std::set<std::string> seen = {}) {
  if (!seen.insert(name).second) throw trackers.error(name, "is `like` itself");
  TableReader table = trackers.table(name);
  if (!table.has("like")) return table.raw();
  const std::string parent = table.text("like");
  if (!trackers.has(parent))
    throw table.error("like", "names no tracker: \"" + parent + "\"", suggestion(parent, trackers.keys()));
  toml::table inherited = resolved(trackers, parent, seen);
  for (const char* key : {"tune", "show", "like"}) inherited.erase(key);
  return merged(inherited, table.raw());
}

std::vector<std::string> names_of(const std::vector<TrackerSpec>& trackers) {
  std::vector<std::string> names;
  for (const TrackerSpec& tracker : trackers) names.push_back(tracker.name);
  return names;
}

// The trackers in the order of their file, which a merged table has lost.
std::vector<std::string> tracker_order(const toml::table& study, const std::filesystem::path& path) {
  TableReader reader(study, path.string());
  const auto trackers = reader.table_if_present("trackers");
  return trackers ? trackers->keys() : std::vector<std::string>{};
}

// `first`, then what only `second` has.
std::vector<std::string> joined(std::vector<std::string> first, const std::vector<std::string>& second) {
  for (const std::string& name : second)
    if (std::find(first.begin(), first.end(), name) == first.end()) first.push_back(name);
  return first;
}

}  // namespace

Study Study::load(const std::filesystem::path& path) {
  Study study;
  study.path_ = path;
  toml::table table = read_toml_file(path);
  std::vector<std::string> order = tracker_order(table, path);
  if (TableReader reader(table, path.string()); reader.has("like")) {
    const std::filesystem::path parent = reader.text("like");
    if (parent.has_parent_path()) throw reader.error("like", "names a folder", "a study beside this one");
    toml::table inherited = read_toml_file(path.parent_path() / parent);
    if (inherited.contains("like")) throw reader.error("like", "names a study that is itself `like` another");
    order = joined(tracker_order(inherited, parent), order);
    table = merged(inherited, table);
  }
  study.read(table, order);
  return study;
}

void Study::read(const toml::table& table, const std::vector<std::string>& order) {
  TableReader reader(table, path_.string());
  reader.node("like");
  name_ = reader.text("name");
  const toml::node* scenario = reader.node("scenario");
  if (scenario && scenario->is_table())
    scenario_ = read_scenario(reader.table("scenario"), kMoreScenarios);
  else
    scenario_ = load_scenario(reader.resolve(reader.text("scenario")), kMoreScenarios);
  if (auto recorded = reader.table_if_present("recorded")) recorded_ = read_recorded_spec(std::move(*recorded));
  if (auto sets = reader.table_if_present("sets"))
    for (const std::string& set : sets->keys()) {
      const std::filesystem::path file = sets->resolve(sets->text(set));
      if (file.extension() == ".csv") {
        sets_.emplace_back(set, recorded_scenario(file));
        continue;
      }
      sets_.emplace_back(set, load_scenario(file, kMoreScenarios));
      if (sets_.back().second->truth_space() != scenario_->truth_space())
        throw sets->error(set, "has another truth than the study's scenario");
    }
  seed_ = static_cast<std::uint64_t>(reader.integer_or("seed", 1, 0, std::numeric_limits<std::int64_t>::max()));
  runs_ = static_cast<std::size_t>(reader.integer_or("runs", 1000, 1, 10000000));
  if (reader.has("parameters")) {
    parameters_path_ = reader.resolve(reader.text("parameters"));
    if (std::filesystem::exists(parameters_path_)) parameters_ = read_parameters_file(parameters_path_);
  }
  if (auto tuning = reader.table_if_present("tuning")) {
    tuning_runs_ = static_cast<std::size_t>(tuning->integer_or("runs", 300, 1, 1000000));
    tuning->finish();
  }
  read_trackers(reader.table("trackers"), order);
  if (auto scoring = reader.table_if_present("scoring")) read_scoring(*scoring);
  reader.finish();
  check_trackers();
}

void Study::read_scoring(TableReader scoring) {
  const std::vector<std::string> names = names_of(trackers_);
  const auto known = [&](const char* key, const std::string& tracker) {
    if (std::find(names.begin(), names.end(), tracker) == names.end())
      throw scoring.error(key, "names no tracker: \"" + tracker + "\"", suggestion(tracker, names));
    return tracker;
  };
  scoring_.from_step = static_cast<int>(scoring.integer_or("from_step", 1, 1, 1000000));
  if (auto thresholds = scoring.table_if_present("loss_thresholds"))
    for (const std::string& quantity : thresholds->keys()) {
      if (scenario_->truth_space().quantity_index(quantity) < 0)
        throw thresholds->error(quantity, "is no quantity of the scenario's truth");
      scoring_.loss_thresholds.emplace_back(quantity, thresholds->number(quantity, kPositive));
    }
  if (scoring.has("pairs"))
    for (const std::string& pair : scoring.texts("pairs")) {
      const std::size_t dash = pair.find(" - ");
      if (dash == std::string::npos)
        throw scoring.error("pairs", "holds \"" + pair + "\"", "\"a - b\" with names of trackers");
      pairs_.emplace_back(known("pairs", pair.substr(0, dash)), known("pairs", pair.substr(dash + 3)));
    }
  read_metrics(scoring, scenario_->truth_space(), scoring_);
  timed_ = read_timed_scoring(scoring, scenario_->truth_space(), scoring_);
  angle_bound_ = read_angle_bound(scoring, scenario_->truth_space());
  if (angle_bound_) check_angle_bound(scoring);
  if (!timed_.global_minimum.empty()) known("global_minimum", timed_.global_minimum);
  if (scoring.has("bounds"))
    for (const std::string& bound : scoring.texts("bounds")) bounds_.push_back(known("bounds", bound));
  scoring.finish();
}

// Only a simulated line array tells how loud its targets are; and the bound is of those that stand still.
void Study::check_angle_bound(TableReader& scoring) const {
  const auto check = [&](const Scenario& scenario, const std::string& which) {
    const auto* array = dynamic_cast<const LineArrayScenario*>(&scenario);
    if (!array)
      throw scoring.error("angle_bound", "needs signal-to-noise ratios, which " + which + " does not tell",
                          "a scenario of kind \"line_array\"");
    if (array->parameters().moving)
      throw scoring.error("angle_bound",
                          "is of targets that stand still inside an interval, and those of " + which + " move");
  };
  if (sets_.empty()) check(*scenario_, "the scenario");
  for (const auto& [name, scenario] : sets_) check(*scenario, "the set \"" + name + "\"");
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

std::unique_ptr<Scenario> Study::recorded_scenario(const std::filesystem::path& file) const {
  return std::make_unique<RecordedFile>(file, recorded_, *scenario_, path_);
}

void Study::read_trackers(TableReader table, const std::vector<std::string>& order) {
  for (const std::string& name : order) {
    TrackerSpec spec;
    spec.name = name;
    spec.configuration = resolved(table, name);
    TableReader reader(spec.configuration, table.file(), "trackers." + name);
    spec.kind = reader.text("kind");
    spec.shown = reader.boolean_or("show", true);
    if (reader.has("tune")) {
      spec.tune = reader.texts("tune");
      for (const std::string& path : spec.tune)
        numbers_at(spec.configuration, path, table.file() + ": trackers." + name + ".tune");
    }
    for (const char* key : kStudyKeys) reader.node(key);
    if (spec.kind == "corrected") {
      spec.correction = read_correction_spec(reader);
      reader.finish();
    }
    for (const char* key : kStudyKeys) spec.configuration.erase(key);
    trackers_.push_back(std::move(spec));
  }
  if (trackers_.empty()) throw table.error("", "names no tracker", "at least one");
}

void Study::check_trackers() {
  for (const TrackerSpec& spec : trackers_) {
    if (!spec.correction) {
      TableReader reader(spec.configuration, path_.string(), "trackers." + spec.name);
      for (const char* key : kStudyKeys) reader.node(key);  // valid too, for whoever misspelt one
      check_replay(spec, *truebearing::make_tracker(spec.kind, reader));
      continue;
    }
    for (const std::string& member : spec.correction->members())
      if (tracker(member).correction)
        throw InputError(path_.string() + ": trackers." + spec.name,
                         "looks at \"" + member + "\", which is itself corrected", "trackers of other kinds");
    for (const auto& [quantity, threshold] : spec.correction->training.leave_out_beyond)
      if (scenario_->truth_space().quantity_index(quantity) < 0)
        throw InputError(path_.string() + ": trackers." + spec.name + ".training.leave_out_beyond." + quantity,
                         "is no quantity of the scenario's truth");
    // Features that the records cannot give are refused here, not at the first step.
    const auto made = [&](const std::string& name) {
      const TrackerSpec& member = tracker(name.empty() ? spec.correction->base : name);
      TableReader reader(member.configuration, path_.string(), "trackers." + member.name);
      return truebearing::make_tracker(member.kind, reader);
    };
    try {
      FeatureExtractor(spec.correction->features, made("")->space(), spec.correction->frame,
                       [&](const std::string& name) { return made(name)->blocks(); });
    } catch (const InputError& error) {
      throw InputError(path_.string() + ": trackers." + spec.name + ": " + error.where(), error.found(), error.valid());
    }
  }
}

// A tracker that replays what measurements carry needs the logs of one.
void Study::check_replay(const TrackerSpec& spec, const Tracker& tracker) {
  const auto* recorded = dynamic_cast<const RecordedTracker*>(&tracker);
  if (!recorded || !recorded->replays_measurements()) return;
  const std::string where = path_.string() + ": trackers." + spec.name;
  auto* logs = dynamic_cast<StepLogScenario*>(scenario_.get());
  if (!logs) throw InputError(where, "has no log to replay", "a key `file`, or a scenario of kind \"step_logs\"");
  if (tracker.space() != logs->truth_space())
    throw InputError(where + ".components", fmt::format("are {}", fmt::join(tracker.space().components, ", ")),
                     fmt::format("{}, as the scenario's logs", fmt::join(logs->truth_space().components, ", ")));
  if (tracker.blocks().innovation) logs->require_innovation();
}

const TrackerSpec& Study::tracker(const std::string& name) const {
  for (const TrackerSpec& spec : trackers_)
    if (spec.name == name) return spec;
  throw InputError(path_.string(), "there is no tracker \"" + name + "\"", suggestion(name, names_of(trackers_)));
}

toml::table Study::configuration_of(const std::string& name) const {
  const TrackerSpec& spec = tracker(name);
  toml::table configuration = spec.configuration;
  if (spec.tune.empty()) return configuration;
  const std::string command = fmt::format("`truebearing tune {}`", path_.string());
  const TunedValues* values = nullptr;
  if (parameters_)
    if (const auto found = parameters_->trackers.find(name); found != parameters_->trackers.end())
      values = &found->second;
  if (!values)
    throw InputError(parameters_path_.empty() ? path_.string() : parameters_path_.string(),
                     "has no tuned parameters of \"" + name + "\"",
                     parameters_path_.empty() ? "a key `parameters` that names their file" : "run " + command);
  for (const std::string& path : spec.tune) {
    const auto found = values->find(path);
    const std::size_t wanted = numbers_at(configuration, path, "trackers." + name + ".tune").size();
    if (found == values->end() || found->second.size() != wanted)
      throw InputError(parameters_path_.string() + ": " + name, "does not hold " + path, "run " + command);
    put_numbers(configuration, path, found->second);
  }
  return configuration;
}

std::string Study::configuration_line(const std::string& name) const {
  return tracker(name).kind + " " + configuration_text(configuration_of(name));
}

std::unique_ptr<Tracker> Study::make_tracker(const std::string& name) const {
  const TrackerSpec& spec = tracker(name);
  if (spec.correction)
    return std::make_unique<CorrectedTracker>(make_ensemble(spec.correction->members()), load_model(name));
  const toml::table configuration = configuration_of(name);
  TableReader reader(configuration, path_.string(), "trackers." + name);
  return truebearing::make_tracker(spec.kind, reader);
}

Ensemble Study::make_ensemble(const std::vector<std::string>& names) const {
  Ensemble ensemble;
  for (const std::string& name : names) ensemble.add(name, make_tracker(name));
  return ensemble;
}

TrackerSet Study::make_tracker_set(const CorrectionModels& models) const {
  std::vector<std::string> members;
  const auto add = [&](const std::string& name) {
    if (std::find(members.begin(), members.end(), name) == members.end()) members.push_back(name);
  };
  for (const TrackerSpec& spec : trackers_) {
    if (!spec.shown) continue;
    if (!spec.correction) {
      add(spec.name);
      continue;
    }
    for (const std::string& member : spec.correction->members()) add(member);
  }
  TrackerSet set(make_ensemble(members));
  for (const TrackerSpec& spec : trackers_) {
    if (!spec.shown) continue;
    if (!spec.correction) {
      set.show_member(spec.name);
      continue;
    }
    const auto given = models.find(spec.name);
    set.show_correction(spec.name, given == models.end() ? load_model(spec.name) : given->second);
  }
  return set;
}

std::shared_ptr<const CorrectionModel> Study::load_model(const std::string& name) const {
  const CorrectionSpec& spec = tracker(name).correction.value();
  if (!std::filesystem::exists(spec.model))
    throw InputError(spec.model.string(), "does not exist", fmt::format("run `truebearing train {}`", path_.string()));
  auto model = std::make_shared<CorrectionModel>(read_model_file(spec.model));
  check_model(name, *model, spec.model.string());
  return model;
}

void Study::check_model(const std::string& name, const CorrectionModel& model, const std::string& where) const {
  const CorrectionSpec& spec = tracker(name).correction.value();
  const std::string remedy = fmt::format("run `truebearing train {}`", path_.string());
  const auto differs = [&](const std::string& what) { return InputError(where, "was trained for " + what, remedy); };
  if (model.features != spec.features) throw differs("other features than the study has for \"" + name + "\"");
  if (model.frame != spec.frame || model.output_in_sigma != spec.output_in_sigma)
    throw differs("another frame or scale of the output");
  if (model.referee != spec.referee || (model.moments.size() > 0) != spec.covariance_moments)
    throw differs("another referee or covariance head");
  if (model.base != spec.base || model.reference != spec.reference || model.covariance_of != spec.covariance_of)
    throw differs("another base, reference or covariance_of");
  if (model.kappa != spec.kappa)
    throw differs(fmt::format("kappa {}, where the study has {}", model.kappa, spec.kappa));
  for (const std::string& member : spec.members()) {
    const auto found = model.trackers.find(member);
    const std::string configuration = configuration_line(member);
    if (found == model.trackers.end() || found->second != configuration)
      throw differs(fmt::format("{} = {}, where the study has {}", member,
                                found == model.trackers.end() ? "nothing" : found->second, configuration));
  }
}

ComparisonOptions Study::comparison_options() const {
  ComparisonOptions options;
  options.seed = seed_;
  options.runs = runs_;
  options.scoring = scoring_;
  options.pairs = pairs_;
  options.bounds = bounds_;
  options.cramer_rao = timed_.cramer_rao;
  options.angle_bound = angle_bound_;
  options.global_minimum = timed_.global_minimum;
  return options;
}

}  // namespace truebearing
