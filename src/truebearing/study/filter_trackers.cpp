#include "truebearing/study/filter_trackers.hpp"

#include <cmath>
#include <limits>
#include <utility>
#include <variant>

#include "truebearing/filter/kalman.hpp"
#include "truebearing/study/bearing_trackers.hpp"
#include "truebearing/study/filter_configuration.hpp"
#include "truebearing/study/plane_filters.hpp"
#include "truebearing/tracker/filter_bank.hpp"
#include "truebearing/tracker/raw_tracker.hpp"
#include "truebearing/tracker/recorded_tracker.hpp"

namespace truebearing {
namespace {

using LineMotion = ConstantVelocity<1, AnyNoise<2>>;

LineMotion read_line_motion(TableReader& tracker) {
  TableReader table = tracker.table("motion");
  table.choice("model", {"constant_velocity"});
  const LineMotion motion{read_noise<1>(table)};
  table.finish();
  return motion;
}

PositionSensor<1> read_line_sensor(TableReader& tracker) {
  TableReader table = tracker.table("measurement");
  table.choice("model", {"position"});
  PositionSensor<1> sensor;
  if (table.has("sigma_m") == table.has("variance_m2"))
    throw table.error("", "has neither or both of sigma_m and variance_m2", "one of the two");
  sensor.sigma_m.setConstant(table.has("sigma_m") ? table.number("sigma_m", kPositive)
                                                  : std::sqrt(table.number("variance_m2", kPositive)));
  sensor.sigma_factor = table.number_or("sigma_factor", 1.0, kPositive);
  table.finish();
  return sensor;
}

// The hypotheses of a bank on the process noise: its covariance times `factor`.
ContinuousWhiteNoise scaled(ContinuousWhiteNoise noise, double factor) {
  return {noise.q * factor};
}
DiscreteWhiteNoise scaled(DiscreteWhiteNoise noise, double factor) {
  return {noise.sigma_a * std::sqrt(factor)};
}
template <int N>
FixedNoise<N> scaled(FixedNoise<N> noise, double factor) {
  noise.Q_per_step *= factor;
  return noise;
}
template <int N>
AnyNoise<N> scaled(const AnyNoise<N>& any, double factor) {
  return std::visit([&](const auto& noise) { return AnyNoise<N>{scaled(noise, factor)}; }, any.noise);
}

}  // namespace

std::unique_ptr<Tracker> make_kalman_tracker(TableReader& table) {
  if (measures_frequencies(table)) return make_frequency_kalman(table);
  if (measures_bearings(table)) return make_bearing_kalman(table);
  if (table.choice_or("space", {"line", "plane"}, "line") == "plane") return make_plane_kalman(table);
  const LineMotion motion = read_line_motion(table);
  const auto make = [&](auto form) -> std::unique_ptr<Tracker> {
    return std::make_unique<FilterTracker<KalmanFilter<2, decltype(form)>, LineMotion, PositionSensor<1>>>(
        line_space(), motion, read_line_sensor(table), read_start<2, 1>(table), read_options(table, 1));
  };
  const std::string form = table.choice_or("form", {"joseph", "square_root", "conventional"}, "joseph");
  if (form == "square_root") return make(SquareRoot{});
  if (form == "conventional") return make(Conventional{});
  return make(Joseph{});
}

std::unique_ptr<Tracker> make_unscented_tracker(TableReader& table) {
  if (measures_frequencies(table)) return make_frequency_unscented(table);
  if (measures_bearings(table)) return make_bearing_unscented(table);
  table.choice("space", {"plane"});
  return make_plane_unscented(table);
}

std::unique_ptr<Tracker> make_multiple_model_tracker(TableReader& table) {
  if (measures_frequencies(table)) return make_frequency_multiple_model(table);
  if (measures_bearings(table)) return make_bearing_multiple_model(table);
  table.choice("space", {"plane"});
  return make_interacting_multiple_model(table);
}

std::unique_ptr<Tracker> make_kalman_bank(TableReader& table) {
  using Bank = FilterBank<KalmanFilter<2>, LineMotion, PositionSensor<1>>;
  const LineMotion motion = read_line_motion(table);
  const PositionSensor<1> sensor = read_line_sensor(table);
  TableReader start = table.table("start");
  const std::vector<double> x0 = start.numbers("x", 2);
  const std::vector<double> variance = start.numbers("variance", 2, kPositive);
  const double start_time_s = start.number_or("time_s", 0.0);
  start.finish();
  const Eigen::Matrix2d P0 = Eigen::Vector2d(variance[0], variance[1]).asDiagonal();
  const std::vector<double> velocities = table.numbers("prior_velocities_mps");
  const std::vector<double> variance_factors = table.numbers("measurement_variance_factors", -1, kPositive);
  const std::vector<double> noise_factors = table.numbers("process_noise_factors", -1, kPositive);

  std::vector<Bank::Hypothesis> hypotheses;
  for (const double velocity_mps : velocities)
    for (const double variance_factor : variance_factors)
      for (const double noise_factor : noise_factors) {
        PositionSensor<1> believed = sensor;
        believed.sigma_factor *= std::sqrt(variance_factor);
        hypotheses.push_back({KalmanFilter<2>(Eigen::Vector2d(x0[0], velocity_mps), P0),
                              LineMotion{scaled(motion.noise, noise_factor)}, believed});
      }
  if (hypotheses.empty() || hypotheses.size() > 100000)
    throw table.error("prior_velocities_mps", "makes a bank of " + std::to_string(hypotheses.size()),
                      "1 to 100000 filters");
  return std::make_unique<Bank>(line_space(), std::move(hypotheses), start_time_s);
}

std::unique_ptr<Tracker> make_raw_tracker(TableReader& table) {
  const std::vector<std::string> components = table.texts("components");
  const std::vector<double> sigma = table.numbers("sigma", static_cast<int>(components.size()), kPositive);
  if (components.size() > kMaxDimension) throw table.error("components", "are too many", "at most 8");
  return std::make_unique<RawTracker>(
      state_space_of_components(components),
      BoundedVector(Eigen::Map<const Eigen::VectorXd>(sigma.data(), static_cast<Eigen::Index>(sigma.size()))));
}

std::unique_ptr<Tracker> make_recorded_tracker(TableReader& table) {
  if (!table.has("file")) {
    const std::vector<std::string> components = table.texts("components");
    if (!table.has("innovation")) throw table.error("innovation", "is missing", "true or false, or a key `file`");
    return std::make_unique<RecordedTracker>(state_space_of_components(components),
                                             table.boolean_or("innovation", false));
  }
  const std::string file = table.text("file");
  return std::make_unique<RecordedTracker>(read_step_log(table.resolve(file), table.text_or("tracker", "")));
}

}  // namespace truebearing
