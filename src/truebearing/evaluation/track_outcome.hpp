// SPDX-License-Identifier: Apache-2.0
// What became of the tracks of one run with several targets: whether each still follows its own target at the end, has
// changed over to another (a swap), or has lost it; and whether any strayed on the way (an excursion).
#pragma once

#include <limits>
#include <span>
#include <string>

namespace truebearing {

struct TrackRule {
  std::string quantity;  ///< of one component: "angle_deg"
  /// A track is bad whose mean signed error over its target's last steps exceeds this, in the quantity's unit.
  double bad = 0.0;
  int last_steps = 5;
  double excursion = std::numeric_limits<double>::infinity();  ///< an error beyond it is one
};

struct TrackOutcome {
  int swapped = 0;  ///< bad tracks that sit within `bad` of another target
  int lost = 0;     ///< the other bad ones, and those that ended before their targets' last steps
  bool excursion = false;

  bool is_swap() const { return swapped > 0; }
  bool is_loss() const { return swapped == 0 && lost > 0; }
  bool is_clean() const { return swapped == 0 && lost == 0 && !excursion; }
};

/// truth, estimates: [target * steps + step], NaN where there is no target, no record of its track, or nothing is
/// scored. Each target is judged over the last steps at which its truth is known.
TrackOutcome track_outcome(std::span<const double> truth, std::span<const double> estimates, std::size_t targets,
                           const TrackRule& rule);

}  // namespace truebearing
