// The true velocity along a recorded track, for which only positions are known: the slope of the least-squares line
// over a sample and its two neighbours on either side, at their actual times.
#pragma once

#include <span>
#include <vector>

namespace truebearing {

/// Velocities at times t (N) of the positions p (N). At the ends the neighbours that exist are used; positions that are
/// NaN are left out. NaN where the position is NaN or fewer than two distinct times remain.
std::vector<double> velocity_truth(std::span<const double> time_s, std::span<const double> position_m);

}  // namespace truebearing
