#include <fmt/format.h>
#include <type_traits>

#include "truebearing/filter/kalman.hpp"
#include "truebearing/filter/log_polar.hpp"
#include "truebearing/filter/modified_gain.hpp"
#include "truebearing/filter/unscented.hpp"
#include "truebearing/study/bearing_trackers.hpp"
#include "truebearing/study/range_bank_configuration.hpp"
#include "truebearing/tracker/range_bank.hpp"

namespace truebearing {

RangeHypotheses read_range_hypotheses(TableReader& table) {
  constexpr int kMost = 10000;
  RangeHypotheses hypotheses{read_range_prior(table.table("start"))};
  hypotheses.ranges = static_cast<int>(table.integer("ranges", 1, kMost));
  hypotheses.velocity_cells = static_cast<int>(table.integer_or("velocity_cells", 1, 1, 360));
  hypotheses.least_range_m = table.number_or("least_range_m", 0.0, kNonNegative);
  if (hypotheses.velocity_cells == 2 || (hypotheses.velocity_cells > 2 && hypotheses.prior.course))
    throw table.error("velocity_cells", fmt::format("is {}", hypotheses.velocity_cells),
                      hypotheses.prior.course ? "1 beside a course" : "1, or 3 and more sectors");
  if (table.has("speed_between_mps")) {
    const std::vector<double> speeds = table.numbers("speed_between_mps", 2, kNonNegative);
    if (speeds[0] >= speeds[1] || hypotheses.velocity_cells == 1)
      throw table.error("speed_between_mps",
                        hypotheses.velocity_cells == 1 ? "stands beside one velocity cell" : "is empty",
                        "[low, high] with low < high, beside velocity_cells");
    hypotheses.speed_between_mps = {speeds[0], speeds[1]};
  }
  if (hypotheses.size() > kMost)
    throw table.error("ranges", fmt::format("makes a bank of {}", hypotheses.size()), fmt::format("1 to {}", kMost));
  return hypotheses;
}

std::unique_ptr<Tracker> make_range_bank(TableReader& table) {
  if (measures_frequencies(table)) return make_frequency_range_bank(table);
  table.choice_or("space", {"plane"}, "plane");
  const VelocityMotion motion = read_velocity_motion(table);
  const BearingSensor sensor = read_bearing_sensor(table);
  const RangeHypotheses hypotheses = read_range_hypotheses(table);
  const std::string filter = table.choice("filter", {"kalman", "unscented", "log_polar", "modified_gain"});
  const auto make = [&]<typename Filter>(std::type_identity<Filter>) {
    return range_bank<Filter>(plane_space(), motion, sensor, hypotheses);
  };
  if (filter == "kalman") return make(std::type_identity<KalmanFilter<4>>());
  if (filter == "unscented") return make(std::type_identity<UnscentedKalmanFilter<4>>());
  if (filter == "log_polar") return make(std::type_identity<LogPolarFilter<>>());
  return make(std::type_identity<ModifiedGainFilter<4>>());
}

}  // namespace truebearing
