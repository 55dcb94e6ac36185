#include "truebearing/filter/unscented.hpp"
#include "truebearing/study/filter_configuration.hpp"
#include "truebearing/study/plane_filters.hpp"

namespace truebearing {

std::unique_ptr<Tracker> make_plane_unscented(TableReader& table) {
  TableReader motion_table = table.table("motion");
  const PlaneMotion motion = read_plane_motion(motion_table);
  motion_table.finish();
  return std::visit(
      [&](const auto& chosen_motion, const auto& chosen_sensor) -> std::unique_ptr<Tracker> {
        using Motion = std::decay_t<decltype(chosen_motion)>;
        return plane_tracker<UnscentedKalmanFilter<Motion::kStates>>(table, chosen_motion, chosen_sensor);
      },
      motion, read_plane_sensor(table));
}

}  // namespace truebearing
