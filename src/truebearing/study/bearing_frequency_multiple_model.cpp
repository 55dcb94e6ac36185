#include "truebearing/study/bearing_frequency_configuration.hpp"
#include "truebearing/study/bearing_multiple_model.hpp"

namespace truebearing {

std::unique_ptr<Tracker> make_frequency_multiple_model(TableReader& table) {
  const StateSpace& space = read_frequency_space(table);
  std::vector<std::variant<FrequencyMotion, AcceleratingFrequencyMotion>> modes;
  for (const PlaneMotion& motion : read_modes(table)) modes.push_back(with_frequency(motion, table));
  const BearingFrequencySensor sensor = read_bearing_frequency_sensor(table);
  if (!std::holds_alternative<AcceleratingFrequencyMotion>(modes.front()))
    return bearing_multiple_model<5>(table, space, all_of_kind<FrequencyMotion>(modes, table), sensor);
  // Kim and Song's own: seven states under the modified gain.
  table.choice("filter", {"modified_gain"});
  return bearing_multiple_model<ModifiedGainFilter<7>>(table, space,
                                                       all_of_kind<AcceleratingFrequencyMotion>(modes, table), sensor);
}

}  // namespace truebearing
