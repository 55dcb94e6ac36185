#include "truebearing/filter/kalman.hpp"
#include "truebearing/study/filter_configuration.hpp"
#include "truebearing/study/plane_filters.hpp"

namespace truebearing {
namespace {

template <typename Form, typename Motion, typename Sensor>
std::unique_ptr<Tracker> make(TableReader& table, const Motion& motion, const Sensor& sensor) {
  return plane_tracker<KalmanFilter<Motion::kStates, Form>>(table, motion, sensor);
}

}  // namespace

std::unique_ptr<Tracker> make_plane_kalman(TableReader& table) {
  TableReader motion_table = table.table("motion");
  const PlaneMotion motion = read_plane_motion(motion_table);
  motion_table.finish();
  const std::variant<PlaneSensor, PolarSensor> sensor = read_plane_sensor(table);
  const std::string form = table.choice_or("form", {"joseph", "square_root", "conventional"}, "joseph");
  return std::visit(
      [&](const auto& chosen_motion, const auto& chosen_sensor) -> std::unique_ptr<Tracker> {
        if (form == "square_root") return make<SquareRoot>(table, chosen_motion, chosen_sensor);
        if (form == "conventional") return make<Conventional>(table, chosen_motion, chosen_sensor);
        return make<Joseph>(table, chosen_motion, chosen_sensor);
      },
      motion, sensor);
}

}  // namespace truebearing
