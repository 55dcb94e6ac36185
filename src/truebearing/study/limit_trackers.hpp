// SPDX-License-Identifier: Apache-2.0
// Trackers that know the family that a study's scenario draws from.
#pragma once

#include <memory>

#include "truebearing/io/table_reader.hpp"
#include "truebearing/simulation/scenario.hpp"
#include "truebearing/tracker/tracker.hpp"

namespace truebearing {

inline constexpr const char* kParticleLimit = "particle_limit";  ///< its kind

/// particles, seed; flights and sensor are the scenario's (tracker/particle_limit.hpp), which is of kind
/// "planar_flight" and measures positions, or ranges and bearings. Of one of kind "passive_sonar" whose target turns once
/// (tracker/turn_limit.hpp) also hand_over_s, measurement, batch and the other keys of a tracker of that kind; a bound of
/// what goes on from that batch.
std::unique_ptr<Tracker> make_particle_limit(TableReader& table, const Scenario& scenario);

/// Whether no tracker's RMSE on that scenario can be below that of the one above: what its recorder does to positions
/// is not modelled.
bool is_limited(const Scenario& scenario);
/// Whether two scenarios draw and measure their flights alike; when they are looked at may differ.
bool are_one_family(const Scenario& a, const Scenario& b);

}  // namespace truebearing
