// SPDX-License-Identifier: Apache-2.0
// The true velocity along a recorded track, for which only positions are known: the slope of the least-squares line
// over a sample and its two neighbours on either side, at their actual times.
#pragma once

#include <span>
#include <vector>

#include "truebearing/core/bounded.hpp"
#include "truebearing/core/state_space.hpp"

namespace truebearing {

/// Velocities at times t (N) of the positions p (N). At the ends the neighbours that exist are used; positions that are
/// NaN are left out. NaN where the position is NaN or fewer than two distinct times remain.
std::vector<double> velocity_truth(std::span<const double> time_s, std::span<const double> position_m);

/// Completes true states x (N, of the space) that give positions only: a component NAME_mps that is not `given`
/// becomes the velocity_truth() of NAME_m, and velocity_mps that of position_m.
void complete_velocities(const StateSpace& space, const std::vector<bool>& given, std::span<const double> time_s,
                         std::span<BoundedVector> x);

}  // namespace truebearing
