#include "truebearing/study/filter_configuration.hpp"

namespace truebearing {

PlaneMotion read_plane_motion(TableReader& motion) {
  const std::string model = motion.choice(
      "model", {"constant_velocity", "coordinated_turn", "constant_acceleration", "singer", "turning_target"});
  if (model == "constant_velocity") return VelocityMotion{ConstantVelocity<2, AnyNoise<4>>{read_noise<2>(motion)}};
  if (model == "coordinated_turn") {
    const double rate_radps = radians(motion.number("turn_rate_degps", {-90.0, 90.0}));
    return VelocityMotion{CoordinatedTurn<AnyNoise<4>>{read_noise<2>(motion), rate_radps}};
  }
  if (model == "constant_acceleration") {
    if (motion.choice("noise", {"continuous", "discrete"}) == "continuous")
      return AccelerationMotion{ConstantAcceleration<2, ContinuousWhiteJerk>{{motion.number("q_m2ps5", kNonNegative)}}};
    return AccelerationMotion{
        ConstantAcceleration<2, DiscreteAccelerationStep>{{motion.number("sigma_mps2", kNonNegative)}}};
  }
  if (model == "singer")
    return AccelerationMotion{
        Singer<2>{motion.number("sigma_a_mps2", kPositive), motion.number("time_constant_s", kPositive)}};
  const double wander = radians(motion.number("turn_rate_noise_degps2", kNonNegative));
  return TurnMotion{read_noise<2>(motion), wander};
}

std::variant<PlaneSensor, PolarSensor> read_plane_sensor(TableReader& tracker) {
  TableReader table = tracker.table("measurement");
  const std::string model = table.choice("model", {"position", "range_bearing", "converted_range_bearing", "bearing"});
  if (model == "bearing")
    throw table.error("model", "is \"bearing\", which this kind of tracker does not take",
                      "a tracker of kind kalman, unscented, modified_gain, log_polar or range_bank");
  const double factor = table.number_or("sigma_factor", 1.0, kPositive);
  if (model == "position") {
    if (table.has("sigma_m") == table.has("variance_m2"))
      throw table.error("", "has neither or both of sigma_m and variance_m2", "one of the two");
    const double sigma_m =
        table.has("sigma_m") ? table.number("sigma_m", kPositive) : std::sqrt(table.number("variance_m2", kPositive));
    table.finish();
    return PlaneSensor{{sigma_m, sigma_m}, factor, false, Eigen::Vector2d::Zero()};
  }
  const Eigen::Vector2d sigma(table.number("range_sigma_m", kPositive),
                              radians(table.number("bearing_sigma_deg", {0.0, 90.0, true})));
  Eigen::Vector2d site_m = Eigen::Vector2d::Zero();
  if (table.has("site_m")) {
    const std::vector<double> site = table.numbers("site_m", 2);
    site_m << site[0], site[1];
  }
  table.finish();
  if (model == "range_bearing") return PolarSensor{sigma, factor, site_m};
  return PlaneSensor{sigma, factor, true, site_m};
}

FilterTrackerOptions read_options(TableReader& tracker, int measurements) {
  FilterTrackerOptions options;
  if (tracker.has("gate_probability"))
    options.gate_nis = chi_square_quantile(tracker.number("gate_probability", {0.5, 1.0 - 1e-12}), measurements);
  options.lost_after_s = tracker.number_or("lost_after_s", std::numeric_limits<double>::infinity(), kPositive);
  options.output_pull = tracker.number_or("output_pull", 0.0, {0.0, 1.0});
  return options;
}

}  // namespace truebearing
