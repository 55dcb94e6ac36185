#include "truebearing/study/bearing_multiple_model.hpp"

namespace truebearing {

std::unique_ptr<Tracker> make_bearing_multiple_model(TableReader& table) {
  table.choice_or("space", {"plane"}, "plane");
  const auto motions = all_of_kind<VelocityMotion>(read_modes(table), table);
  return bearing_multiple_model<4>(table, plane_space(), motions, read_bearing_sensor(table));
}

}  // namespace truebearing
