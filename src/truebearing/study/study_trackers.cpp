// SPDX-License-Identifier: Apache-2.0
// The trackers that a study names, made: with their tuned numbers, and corrected by their models.
#include <algorithm>
#include <fmt/format.h>
#include <toml++/toml.h>

#include "truebearing/core/constants.hpp"
#include "truebearing/core/suggestion.hpp"
#include "truebearing/correction/corrected_tracker.hpp"
#include "truebearing/study/configuration_text.hpp"
#include "truebearing/study/smoother_trackers.hpp"
#include "truebearing/study/study.hpp"
#include "truebearing/study/tracker_registry.hpp"

namespace truebearing {

const TrackerSpec& Study::tracker(const std::string& name) const {
  for (const TrackerSpec& spec : trackers_)
    if (spec.name == name) return spec;
  throw InputError(path_.string(), "there is no tracker \"" + name + "\"", suggestion(name, names_of(trackers_)));
}

void Study::show_all() {
  for (TrackerSpec& spec : trackers_) spec.shown = true;
}

SharedTable Study::configuration_of(const std::string& name) const {
  const TrackerSpec& spec = tracker(name);
  SharedTable configuration = spec.configuration;
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
    const std::size_t wanted = numbers_at(*configuration, path, "trackers." + name + ".tune").size();
    if (found == values->end() || found->second.size() != wanted)
      throw InputError(parameters_path_.string() + ": " + name, "does not hold " + path, "run " + command);
    configuration = with_numbers(*configuration, path, found->second);
  }
  return configuration;
}

void Study::smooth_all(double lag_s, const std::function<void(const std::string& name)>& left_out) {
  std::vector<TrackerSpec> smoothers;
  for (TrackerSpec& spec : trackers_) {
    if (!spec.shown || spec.smoother) continue;
    spec.shown = false;
    TrackerSpec smoother;
    smoother.name = spec.name + "_smoothed";
    smoother.kind = kSmoother;
    smoother.configuration = std::make_shared<const toml::table>();
    smoother.smoother = SmootherSpec{spec.name, lag_s};
    const auto named = std::find_if(trackers_.begin(), trackers_.end(),
                                    [&](const TrackerSpec& other) { return other.name == smoother.name; });
    if (named != trackers_.end()) {  // the study has it, but for the lag
      if (named->smoother && lag_s < kInfinity) named->smoother->lag_s = lag_s;
      continue;
    }
    if (spec.correction || !can_be_smoothed(*make_tracker(spec.name)))
      left_out(spec.name);
    else
      smoothers.push_back(std::move(smoother));
  }
  trackers_.insert(trackers_.end(), smoothers.begin(), smoothers.end());
  // What the study compares is not shown any more.
  scoring_.pairs.clear();
  scoring_.bounds.clear();
}

bool Study::looks_back() const {
  return std::any_of(trackers_.begin(), trackers_.end(),
                     [](const TrackerSpec& spec) { return spec.shown && spec.smoother; });
}

std::string Study::configuration_line(const std::string& name) const {
  const TrackerSpec& spec = tracker(name);
  const std::string own = spec.kind + " " + configuration_text(*configuration_of(name));
  return spec.smoother ? fmt::format("{} of {}", own, configuration_line(spec.smoother->of)) : own;
}

std::unique_ptr<Tracker> Study::make_tracker(const std::string& name, const CorrectionModels& models) const {
  const TrackerSpec& spec = tracker(name);
  if (spec.correction) {
    const auto given = models.find(name);
    return std::make_unique<CorrectedTracker>(make_ensemble(spec.correction->members()),
                                              given == models.end() ? load_model(name) : given->second,
                                              spec.correction->bounds);
  }
  if (spec.smoother) return make_smoother(make_tracker(spec.smoother->of), *spec.smoother, spec.where);
  TableReader reader = tracker_reader(spec, configuration_of(name), path_.string());
  return truebearing::make_tracker(spec.kind, reader, scenario_.get());
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
    set.show_correction(spec.name, given == models.end() ? load_model(spec.name) : given->second,
                        spec.correction->bounds);
  }
  return set;
}

}  // namespace truebearing
