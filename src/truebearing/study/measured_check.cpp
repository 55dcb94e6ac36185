// SPDX-License-Identifier: Apache-2.0
#include "truebearing/study/measured_check.hpp"

#include <fmt/format.h>

#include "truebearing/core/error.hpp"
#include "truebearing/study/study.hpp"

namespace truebearing {

namespace {

void check_one(const Tracker& tracker, const std::string& where, const Measured& given, const std::string& giver) {
  const std::optional<Measured> taken = tracker.measures();
  if (!taken) return;
  if (const auto reason = mismatch(*taken, given, giver)) throw InputError(where, *reason);
}

}  // namespace

void check_measured(const Tracker& tracker, const std::string& where, const Scenario& scenario,
                    const ScenarioSets& sets) {
  const auto check = [&](const Scenario& one, const std::string& giver) {
    if (const std::optional<Measured> given = one.measured()) check_one(tracker, where, *given, giver);
  };
  check(scenario, "the scenario");
  for (const auto& [name, set] : sets) check(*set, "the set \"" + name + "\"");
}

void check_measured(const Study& study, const Measured& given, const std::string& giver) {
  const auto check = [&](const std::string& name) {
    check_one(*study.make_tracker(name), study.tracker(name).where, given, giver);
  };
  for (const TrackerSpec& spec : study.trackers()) {
    if (!spec.shown) continue;
    if (!spec.correction)
      check(spec.name);
    else
      for (const std::string& member : spec.correction->members()) check(member);
  }
}

void check_measured(const std::vector<std::string>& columns, const Scenario& scenario, const std::string& where) {
  const std::optional<Measured> wanted = scenario.measured();
  if (wanted && !wanted->sources.empty()) return;  // of which a log may lack some: its reader says where it lacks all
  if (wanted && !wanted->is_step_log() && columns != wanted->components)
    throw InputError(where, fmt::format("measures {}", fmt::join(columns, ", ")),
                     fmt::format("{}, which the study's trackers take", fmt::join(wanted->components, ", ")));
}

}  // namespace truebearing
