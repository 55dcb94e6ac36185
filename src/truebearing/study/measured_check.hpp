// SPDX-License-Identifier: Apache-2.0
// A study's trackers take what its scenario measures, and so does a log that it is given: compared by name as it is
// read. Who does not say what it takes or gives takes or gives anything.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "truebearing/simulation/scenario.hpp"
#include "truebearing/tracker/tracker.hpp"

namespace truebearing {

class Study;

using ScenarioSets = std::vector<std::pair<std::string, std::unique_ptr<Scenario>>>;  // by name

/// Throws InputError in the name of `where` ("study.toml: trackers.plain") where the tracker cannot use what the
/// scenario or one of the sets gives.
void check_measured(const Tracker& tracker, const std::string& where, const Scenario& scenario,
                    const ScenarioSets& sets);

/// The same of every tracker that the study shows, and what "log.h5" gives.
void check_measured(const Study& study, const Measured& given, const std::string& giver);

/// Throws InputError in the name of `where` unless these are the columns that the scenario measures.
void check_measured(const std::vector<std::string>& columns, const Scenario& scenario, const std::string& where);

}  // namespace truebearing
