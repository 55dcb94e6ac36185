// SPDX-License-Identifier: Apache-2.0
#include "truebearing/study/measured_check.hpp"

#include <fmt/format.h>

#include "truebearing/core/error.hpp"

namespace truebearing {

void check_measured(const Tracker& tracker, const std::string& where, const Scenario& scenario,
                    const ScenarioSets& sets) {
  const std::optional<Measured> taken = tracker.measures();
  const auto check = [&](const Scenario& one, const std::string& giver) {
    const std::optional<Measured> given = one.measured();
    if (!taken || !given) return;
    if (const auto reason = mismatch(*taken, *given, giver)) throw InputError(where, *reason);
  };
  check(scenario, "the scenario");
  for (const auto& [name, set] : sets) check(*set, "the set \"" + name + "\"");
}

void check_measured(const std::vector<std::string>& columns, const Scenario& scenario, const std::string& where) {
  const std::optional<Measured> wanted = scenario.measured();
  if (wanted && !wanted->is_step_log() && columns != wanted->components)
    throw InputError(where, fmt::format("measures {}", fmt::join(columns, ", ")),
                     fmt::format("{}, which the study's trackers take", fmt::join(wanted->components, ", ")));
}

}  // namespace truebearing
