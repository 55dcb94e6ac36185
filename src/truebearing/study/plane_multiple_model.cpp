#include <fmt/format.h>

#include "truebearing/filter/interacting_multiple_model.hpp"
#include "truebearing/filter/kalman.hpp"
#include "truebearing/study/filter_configuration.hpp"
#include "truebearing/study/plane_filters.hpp"

namespace truebearing {
namespace {

using VelocityMode = Mode<KalmanFilter<4>, VelocityMotion>;
using AccelerationMode = Mode<KalmanFilter<6>, AccelerationMotion>;
using TurnMode = Mode<KalmanFilter<5>, TurnMotion>;

// One table of `modes` is one mode, or with turn_rates_degps one for each rate.
void read_modes(TableReader table, std::vector<PlaneMotion>& motions) {
  if (!table.has("turn_rates_degps")) {
    motions.push_back(read_plane_motion(table));
    table.finish();
    return;
  }
  table.choice("model", {"coordinated_turn"});
  const AnyNoise<4> noise = read_noise<2>(table);
  for (const double rate_degps : table.numbers("turn_rates_degps", -1, {-90.0, 90.0}))
    motions.push_back(VelocityMotion{CoordinatedTurn<AnyNoise<4>>{noise, radians(rate_degps)}});
  table.finish();
}

// transition = { matrix = [...], period_s } row by row, or { leave_first, leave_other, to_first, period_s }.
MarkovChain read_chain(TableReader& tracker, int modes) {
  constexpr double kRounding = 1e-6;
  constexpr Range kProbability{0.0, 1.0};
  TableReader table = tracker.table("transition");
  const double period_s = table.number("period_s", kPositive);
  MarkovChain chain;
  if (table.has("matrix")) {
    const std::vector<double> numbers = table.numbers("matrix", modes * modes, kProbability);
    chain.transition = Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
        numbers.data(), modes, modes);
    for (Eigen::Index i = 0; i < modes; ++i)
      if (std::abs(chain.transition.row(i).sum() - 1.0) > kRounding)
        throw table.error("matrix", fmt::format("has a row {} that does not sum to 1", i + 1), "probabilities");
    chain.initial = BoundedVector::Constant(modes, 1.0 / modes);
    chain.period_s = period_s;
  } else {
    chain = star_chain(modes, table.number("leave_first", kProbability), table.number("leave_other", kProbability),
                       modes > 2 ? table.number("to_first", kProbability) : 1.0, period_s);
  }
  if (tracker.has("initial")) {
    const std::vector<double> initial = tracker.numbers("initial", modes, kProbability);
    chain.initial = Eigen::Map<const Eigen::VectorXd>(initial.data(), modes);
    if (std::abs(chain.initial.sum() - 1.0) > kRounding)
      throw tracker.error("initial", "does not sum to 1", "probabilities");
  }
  table.finish();
  return chain;
}

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
  std::vector<PlaneMotion> motions;
  for (TableReader& mode : table.tables("modes")) read_modes(mode, motions);
  if (motions.size() < 2 || motions.size() > static_cast<std::size_t>(kMaxDimension))
    throw table.error("modes", fmt::format("makes {} of them", motions.size()), fmt::format("2 to {}", kMaxDimension));
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
