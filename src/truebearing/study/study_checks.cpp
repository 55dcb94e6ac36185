// SPDX-License-Identifier: Apache-2.0
// What of a study cannot be right is refused when it is read, and a model that is not its own before it runs.
#include <algorithm>
#include <fmt/format.h>

#include "truebearing/core/suggestion.hpp"
#include "truebearing/correction/feature_extractor.hpp"
#include "truebearing/correction/model_file.hpp"
#include "truebearing/study/limit_trackers.hpp"
#include "truebearing/study/measured_check.hpp"
#include "truebearing/study/smoother_trackers.hpp"
#include "truebearing/study/study.hpp"
#include "truebearing/study/tracker_registry.hpp"
#include "truebearing/tracker/recorded_tracker.hpp"
#include "truebearing/tracker/step_log_scenario.hpp"

namespace truebearing {

void Study::check_trackers() {
  for (const TrackerSpec& spec : trackers_) {
    if (lacks_motion(spec)) continue;
    if (spec.smoother) {
      check_smoother(spec);
      continue;
    }
    if (!spec.correction) {
      TableReader reader = tracker_reader(spec, spec.configuration, path_.string());
      ask_for_study_keys(reader);
      const std::unique_ptr<Tracker> tracker = truebearing::make_tracker(spec.kind, reader, scenario_.get());
      check_replay(spec, *tracker);
      check_measured(*tracker, spec.where, *scenario_, sets_);
      if (spec.kind == kParticleLimit) check_limit(spec);
      continue;
    }
    for (const std::string& member : spec.correction->members())
      if (tracker(member).smoother)
        throw InputError(spec.where, "looks at \"" + member + "\", a smoother, which knows what is yet to be measured",
                         "trackers of other kinds");
      else if (tracker(member).correction)
        throw InputError(spec.where, "looks at \"" + member + "\", which is itself corrected",
                         "trackers of other kinds");
    check_teacher(spec);
    for (const auto& [quantity, threshold] : spec.correction->training.leave_out_beyond)
      if (scenario_->truth_space().quantity_index(quantity) < 0)
        throw InputError(spec.where + ".training.leave_out_beyond." + quantity,
                         "is no quantity of the scenario's truth");
    // Features that the records cannot give are refused here, not at the first step.
    const auto made = [&](const std::string& name) {
      const TrackerSpec& member = tracker(name.empty() ? spec.correction->design.base : name);
      TableReader reader = tracker_reader(member, member.configuration, path_.string());
      return truebearing::make_tracker(member.kind, reader, scenario_.get());
    };
    // A referee holds foretold positions against measured ones.
    if (spec.correction->bounds.referee && !made("")->blocks().measures_position)
      throw InputError(spec.where + ".referee",
                       "wants measured positions, and the base \"" + spec.correction->design.base + "\" has others",
                       "a base that measures positions alone, or no referee");
    try {
      FeatureExtractor(spec.correction->design.features, made("")->space(), spec.correction->design.frame,
                       [&](const std::string& name) { return made(name)->blocks(); });
    } catch (const InputError& error) {
      throw InputError(spec.where + ": " + error.where(), error.found(), error.valid());
    }
  }
}

// Whether it, or a tracker that it looks at, moves by what is yet to be learned: who makes it then is told what to run.
bool Study::lacks_motion(const TrackerSpec& spec) const {
  const auto lacks = [](const TrackerSpec& one) { return one.learned && !std::filesystem::exists(one.learned->file); };
  if (spec.smoother)
    return std::any_of(trackers_.begin(), trackers_.end(),
                       [&](const TrackerSpec& one) { return one.name == spec.smoother->of && lacks(one); });
  if (!spec.correction) return lacks(spec);
  const std::vector<std::string> members = spec.correction->members();
  return std::any_of(members.begin(), members.end(), [&](const std::string& name) { return lacks(tracker(name)); });
}

void Study::check_smoother(const TrackerSpec& spec) const {
  const std::vector<std::string> names = names_of(trackers_);
  const std::string& of = spec.smoother->of;
  if (std::find(names.begin(), names.end(), of) == names.end())
    throw InputError(spec.where + ".of", "names no tracker: \"" + of + "\"", suggestion(of, names));
  const TrackerSpec& filter = tracker(of);
  if (filter.correction || filter.smoother)
    throw InputError(spec.where + ".of", "is \"" + of + "\", which is no filter", "a filter of the study");
  TableReader reader = tracker_reader(filter, filter.configuration, path_.string());
  const std::unique_ptr<Tracker> smoother =
      make_smoother(truebearing::make_tracker(filter.kind, reader, scenario_.get()), *spec.smoother, spec.where);
  check_measured(*smoother, spec.where, *scenario_, sets_);
}

// A smoother that stands for the truth, of the same state as what it teaches.
void Study::check_teacher(const TrackerSpec& spec) const {
  const std::string& teacher = spec.correction->training.teacher;
  if (teacher.empty()) return;
  std::vector<std::string> smoothers;
  for (const TrackerSpec& other : trackers_)
    if (other.smoother) smoothers.push_back(other.name);
  const std::string where = spec.where + ".training.teacher";
  if (smoothers.empty())
    throw InputError(where, "is \"" + teacher + "\", and the study has no smoother", "a tracker of kind \"smoother\"");
  if (std::find(smoothers.begin(), smoothers.end(), teacher) == smoothers.end())
    throw InputError(where, "names no smoother: \"" + teacher + "\"", suggestion(teacher, smoothers));
}

// What knows the family is a bound of it, named as one or not.
void Study::check_limit(const TrackerSpec& spec) {
  for (const auto& [name, set] : sets_)
    if (!are_one_family(*scenario_, *set))
      throw InputError(spec.where, "is the limit of the scenario's family, and the set \"" + name + "\" is of another",
                       "sets that differ in their looks alone");
  const bool is_named = std::find(scoring_.bounds.begin(), scoring_.bounds.end(), spec.name) != scoring_.bounds.end();
  if (!is_limited(*scenario_)) {
    if (is_named)
      throw InputError(path_.string() + ": scoring.bounds",
                       "names \"" + spec.name + "\", which does not model the recorder's jitter of the scenario",
                       "no such bound, or a scenario without [jitter]");
    return;
  }
  limits_.push_back(spec.name);
  if (!is_named && spec.shown) scoring_.bounds.push_back(spec.name);
}

std::string Study::note() const {
  std::string note;
  for (const TrackerSpec& spec : trackers_)
    if (spec.kind == kParticleLimit && spec.shown && !is_limited(*scenario_))
      note += fmt::format("{}: is no bound here: it does not model the recorder's jitter\n", spec.name);
  return note;
}

// A tracker that replays what measurements carry needs the logs of one.
void Study::check_replay(const TrackerSpec& spec, const Tracker& tracker) {
  const auto* recorded = dynamic_cast<const RecordedTracker*>(&tracker);
  if (!recorded || !recorded->replays_measurements()) return;
  auto* logs = dynamic_cast<StepLogScenario*>(scenario_.get());
  if (!logs) throw InputError(spec.where, "has no log to replay", "a key `file`, or a scenario of kind \"step_logs\"");
  if (tracker.space() != logs->truth_space())
    throw InputError(spec.where + ".components", fmt::format("are {}", fmt::join(tracker.space().components, ", ")),
                     fmt::format("{}, as the scenario's logs", fmt::join(logs->truth_space().components, ", ")));
  if (tracker.blocks().innovation) logs->require_innovation();
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
  if (model.design != spec.design)
    throw differs("another " + differences(model.design, spec.design) + " than the study has for \"" + name + "\"");
  if (spec.bounds.gate && !model.gate)
    throw InputError(where, "holds no box, which the gate of \"" + name + "\" wants", remedy + ", or gate = false");
  for (const std::string& member : spec.design.members()) {
    const auto found = model.trackers.find(member);
    const std::string configuration = configuration_line(member);
    if (found == model.trackers.end() || found->second != configuration)
      throw differs(fmt::format("{} = {}, where the study has {}", member,
                                found == model.trackers.end() ? "nothing" : found->second, configuration));
  }
}

}  // namespace truebearing
