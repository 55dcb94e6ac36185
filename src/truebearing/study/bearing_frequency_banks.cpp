#include "truebearing/filter/kalman.hpp"
#include "truebearing/filter/modified_gain.hpp"
#include "truebearing/filter/unscented.hpp"
#include "truebearing/study/bearing_frequency_configuration.hpp"
#include "truebearing/study/range_bank_configuration.hpp"
#include "truebearing/tracker/range_bank.hpp"

namespace truebearing {

std::unique_ptr<Tracker> make_frequency_range_bank(TableReader& table) {
  const StateSpace& space = plane_frequency_space();
  table.choice_or("space", {space.name}, space.name);
  const FrequencyMotion motion{read_velocity_motion(table), table.number_or("frequency_q_hz2ps", 0.0, kNonNegative)};
  const BearingFrequencySensor sensor = read_bearing_frequency_sensor(table);
  const RangeHypotheses hypotheses = read_range_hypotheses(table);
  const std::string filter = table.choice("filter", {"kalman", "unscented", "modified_gain"});
  if (filter == "kalman") return range_bank<KalmanFilter<5>>(space, motion, sensor, hypotheses);
  if (filter == "unscented") return range_bank<UnscentedKalmanFilter<5>>(space, motion, sensor, hypotheses);
  return range_bank<ModifiedGainFilter<5>>(space, motion, sensor, hypotheses);
}

}  // namespace truebearing
