// What the makers of trackers of bearings and frequencies share.
#pragma once

#include <variant>

#include "truebearing/motion/with_frequency.hpp"
#include "truebearing/study/bearing_trackers.hpp"

namespace truebearing {

/// Motions with the frequency of the source: of five components, and Kim and Song's of seven.
using FrequencyMotion = WithFrequency<VelocityMotion>;
using AcceleratingFrequencyMotion = WithFrequency<AccelerationMotion>;

/// space = "plane_frequency" | "plane".
inline const StateSpace& read_frequency_space(TableReader& table) {
  return *find_state_space(table.choice_or("space", {"plane", "plane_frequency"}, "plane_frequency"));
}

/// A motion of positions and velocities, or with accelerations, with frequency_q_hz2ps of the tracker's table.
inline std::variant<FrequencyMotion, AcceleratingFrequencyMotion> with_frequency(const PlaneMotion& motion,
                                                                                 TableReader& tracker) {
  const double q = tracker.number_or("frequency_q_hz2ps", 0.0, kNonNegative);
  if (const auto* accelerating = std::get_if<AccelerationMotion>(&motion))
    return AcceleratingFrequencyMotion{*accelerating, q};
  if (const auto* velocity = std::get_if<VelocityMotion>(&motion)) return FrequencyMotion{*velocity, q};
  throw tracker.error("motion", "estimates a turn rate, which no tracker of frequencies does",
                      "constant_velocity, coordinated_turn, constant_acceleration or singer");
}

}  // namespace truebearing
