// What the makers of filter trackers share: from tables of a study to motion models, sensors, starts and options. A
// study chooses at run time what filters fix at compile time; models of one state stand behind one type (OneOf,
// AnyNoise), so that they do not multiply the number of filters that are compiled.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "truebearing/core/angle.hpp"
#include "truebearing/core/chi_square.hpp"
#include "truebearing/io/table_reader.hpp"
#include "truebearing/motion/constant_acceleration.hpp"
#include "truebearing/motion/constant_velocity.hpp"
#include "truebearing/motion/coordinated_turn.hpp"
#include "truebearing/motion/one_of.hpp"
#include "truebearing/motion/singer.hpp"
#include "truebearing/motion/turning_target.hpp"
#include "truebearing/tracker/filter_tracker.hpp"
#include "truebearing/tracker/plane_sensor.hpp"
#include "truebearing/tracker/position_sensor.hpp"

namespace truebearing {

/// Models in the plane by the length of their state: velocities; accelerations; a turn rate.
using VelocityMotion = OneOf<ConstantVelocity<2, AnyNoise<4>>, CoordinatedTurn<AnyNoise<4>>>;
using AccelerationMotion =
    OneOf<ConstantAcceleration<2, ContinuousWhiteJerk>, ConstantAcceleration<2, DiscreteAccelerationStep>, Singer<2>>;
using TurnMotion = TurningTarget<AnyNoise<4>>;
using PlaneMotion = std::variant<VelocityMotion, AccelerationMotion, TurnMotion>;

/// noise = "fixed" | "discrete" | "continuous" and its number.
template <int D>
AnyNoise<2 * D> read_noise(TableReader& table) {
  const std::string kind = table.choice("noise", {"fixed", "discrete", "continuous"});
  if (kind == "discrete") return {DiscreteWhiteNoise{table.number("sigma_a_mps2", kNonNegative)}};
  if (kind == "continuous") return {ContinuousWhiteNoise{table.number("q_m2ps3", kNonNegative)}};
  const std::vector<double> variance = table.numbers("variance", 2 * D, kNonNegative);
  const double period_s = table.number("period_s", kPositive);
  return {FixedNoise<2 * D>{Eigen::Map<const Eigen::Matrix<double, 2 * D, 1>>(variance.data()).asDiagonal(), period_s}};
}

/// A motion in the plane, all keys but those that the caller asks for itself.
PlaneMotion read_plane_motion(TableReader& motion);

std::variant<PlaneSensor, PolarSensor> read_plane_sensor(TableReader& tracker);

FilterTrackerOptions read_options(TableReader& tracker, int measurements);

/// start = { kind = "prior" | "one_point" | "two_point", ... } for a state of N components of which 2 D are positions
/// and velocities.
template <int N, int D>
std::variant<PriorStart<N>, TwoPointStart, OnePointStart> read_start(TableReader& tracker) {
  TableReader table = tracker.table("start");
  const std::string kind = table.choice("kind", {"prior", "one_point", "two_point"});
  // Of the components behind the velocities: accelerations or a turn rate.
  const double rest = N > 2 * D && kind != "prior" ? table.number("rest_sigma", kNonNegative) : 0.0;
  if (kind == "two_point") {
    table.finish();
    return TwoPointStart{rest};
  }
  if (kind == "one_point") {
    const OnePointStart start{table.number("velocity_sigma_mps", kPositive), rest};
    table.finish();
    return start;
  }
  const std::vector<double> x = table.numbers("x", N);
  const std::vector<double> variance = table.numbers("variance", N, kPositive);
  PriorStart<N> prior;
  prior.x = Eigen::Map<const Eigen::Matrix<double, N, 1>>(x.data());
  prior.P = Eigen::Map<const Eigen::Matrix<double, N, 1>>(variance.data()).asDiagonal();
  prior.time_s = table.number_or("time_s", 0.0);
  table.finish();
  return prior;
}

/// A FilterTracker in the plane.
template <typename Filter, typename Motion, typename Sensor>
std::unique_ptr<Tracker> plane_tracker(TableReader& table, const Motion& motion, const Sensor& sensor) {
  using Made = FilterTracker<Filter, Motion, Sensor>;
  const typename Made::Start start = read_start<Filter::kStates, 2>(table);
  const bool from_measurements = !std::holds_alternative<typename Made::Prior>(start);
  if (from_measurements && !Sensor::kMeasuresPosition)
    throw table.error("start", "needs measured positions", "kind = \"prior\", or model = \"converted_range_bearing\"");
  const FilterTrackerOptions options = read_options(table, 2);
  if (options.output_pull > 0.0 && !Sensor::kMeasuresPosition)
    throw table.error("output_pull", "needs measured positions", "0, or model = \"converted_range_bearing\"");
  return std::make_unique<Made>(plane_space(), motion, sensor, start, options);
}

}  // namespace truebearing
