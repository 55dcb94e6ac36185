#include "truebearing/study/multiple_model_configuration.hpp"

#include <cmath>
#include <fmt/format.h>

namespace truebearing {
namespace {

// One table of `modes` is one mode, or with turn_rates_degps one for each rate.
void read_mode(TableReader table, std::vector<PlaneMotion>& motions) {
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

}  // namespace

std::vector<PlaneMotion> read_modes(TableReader& tracker) {
  std::vector<PlaneMotion> motions;
  for (TableReader& mode : tracker.tables("modes")) read_mode(mode, motions);
  if (motions.size() < 2 || motions.size() > static_cast<std::size_t>(kMaxModes))
    throw tracker.error("modes", fmt::format("makes {} of them", motions.size()), fmt::format("2 to {}", kMaxModes));
  return motions;
}

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
    chain.initial = ModeVector::Constant(modes, 1.0 / modes);
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

}  // namespace truebearing
