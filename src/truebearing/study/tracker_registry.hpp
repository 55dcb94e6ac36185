// SPDX-License-Identifier: Apache-2.0
// The one table from names in study files to makers of trackers. It is open: a program registers its own before it
// reads a study.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "truebearing/io/table_reader.hpp"
#include "truebearing/simulation/scenario.hpp"
#include "truebearing/tracker/tracker.hpp"

namespace truebearing {

/// The kind of those that look back over what another tracker of the study did (SmootherSpec).
inline constexpr const char* kSmoother = "smoother";

/// Makes a tracker from its table in a study. Keys that the maker does not ask for are errors; `kind`, `like`, `tune`
/// and `show` are read by the study itself. Throws InputError.
using TrackerMaker = std::function<std::unique_ptr<Tracker>(TableReader& configuration)>;

/// Adds a kind of tracker. Throws InputError where the name is taken.
void register_tracker(const std::string& kind, TrackerMaker maker);

/// Throws InputError that lists the valid kinds where there is none of that name. Kinds that know the family that a
/// study's scenario draws from need that scenario, which only has to outlive the call.
std::unique_ptr<Tracker> make_tracker(const std::string& kind, TableReader& configuration,
                                      const Scenario* scenario = nullptr);

std::vector<std::string> tracker_kinds();

}  // namespace truebearing
