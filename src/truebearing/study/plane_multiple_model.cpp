#include <algorithm>

#include "truebearing/filter/interacting_multiple_model.hpp"
#include "truebearing/filter/kalman.hpp"
#include "truebearing/study/multiple_model_configuration.hpp"
#include "truebearing/study/plane_filters.hpp"

namespace truebearing {
namespace {

using VelocityMode = Mode<KalmanFilter<4>, VelocityMotion>;
using AccelerationMode = Mode<KalmanFilter<6>, AccelerationMotion>;
using TurnMode = Mode<KalmanFilter<5>, TurnMotion>;

template <typename... Modes>
std::unique_ptr<Tracker> make(TableReader& table, const std::vector<PlaneMotion>& motions, const MarkovChain& chain,
                              const std::variant<PlaneSensor, PolarSensor>& sensor) {
  MultipleModels<Modes...> models{{}, chain};
  const auto add = [&](const auto& motion) {
    using Motion = std::decay_t<decltype(motion)>;
    constexpr bool known = (std::is_same_v<Mode<KalmanFilter<Motion::kStates>, Motion>, Modes> || ...);
    if constexpr (known) models.modes.push_back(Mode<KalmanFilter<Motion::kStates>, Motion>{motion});
  };
  for (const PlaneMotion& motion : motions) std::visit(add, motion);
  return std::visit(
      [&](const auto& chosen) { return plane_tracker<InteractingMultipleModel<Modes...>>(table, models, chosen); },
      sensor);
}

}  // namespace

std::unique_ptr<Tracker> make_interacting_multiple_model(TableReader& table) {
  const std::vector<PlaneMotion> motions = read_modes(table);
  const MarkovChain chain = read_chain(table, static_cast<int>(motions.size()));
  const std::variant<PlaneSensor, PolarSensor> sensor = read_plane_sensor(table);
  const auto any = [&](auto motion) {
    return std::any_of(motions.begin(), motions.end(),
                       [](const PlaneMotion& m) { return std::holds_alternative<decltype(motion)>(m); });
  };
  const bool accelerates = any(AccelerationMotion{}), turns = any(TurnMotion{});
  if (accelerates && turns)
    throw table.error("modes", "mix accelerations and turn rates, which are no parts of one state",
                      "one of the two beside constant velocity and coordinated turns");
  if (accelerates) return make<VelocityMode, AccelerationMode>(table, motions, chain, sensor);
  if (turns) return make<VelocityMode, TurnMode>(table, motions, chain, sensor);
  return make<VelocityMode>(table, motions, chain, sensor);
}

}  // namespace truebearing
