#include "truebearing/study/filter_trackers.hpp"

#include <cmath>
#include <limits>
#include <utility>
#include <variant>

#include "truebearing/core/chi_square.hpp"
#include "truebearing/filter/kalman.hpp"
#include "truebearing/motion/constant_velocity.hpp"
#include "truebearing/tracker/filter_bank.hpp"
#include "truebearing/tracker/filter_tracker.hpp"
#include "truebearing/tracker/position_sensor.hpp"
#include "truebearing/tracker/raw_tracker.hpp"
#include "truebearing/tracker/recorded_tracker.hpp"

namespace truebearing {
namespace {

// A study chooses at run time what the filters fix at compile time. Each of these reads one choice and calls `use` with
// a value of the type that was chosen.

template <typename Use>
auto with_dimension(TableReader& table, const Use& use) {
  if (table.choice_or("space", {"line", "plane"}, "line") == "plane") return use(std::integral_constant<int, 2>{});
  return use(std::integral_constant<int, 1>{});
}

template <int D>
AnyNoise<2 * D> read_noise(TableReader& table) {
  const std::string kind = table.choice("noise", {"fixed", "discrete", "continuous"});
  if (kind == "discrete") return {DiscreteWhiteNoise{table.number("sigma_a_mps2", kNonNegative)}};
  if (kind == "continuous") return {ContinuousWhiteNoise{table.number("q_m2ps3", kNonNegative)}};
  const std::vector<double> variance = table.numbers("variance", 2 * D, kNonNegative);
  const double period_s = table.number("period_s", kPositive);
  return {FixedNoise<2 * D>{Eigen::Map<const Eigen::Matrix<double, 2 * D, 1>>(variance.data()).asDiagonal(), period_s}};
}

// The noises behind one type, so that they do not multiply the number of filters that are compiled.
template <int D>
using Motion = ConstantVelocity<D, AnyNoise<2 * D>>;

template <int D>
Motion<D> read_motion(TableReader& tracker) {
  TableReader table = tracker.table("motion");
  table.choice("model", {"constant_velocity"});
  const Motion<D> motion{read_noise<D>(table)};
  table.finish();
  return motion;
}

// Type<N>::Filter names a filter: what `use` gets is a tag, since filters begin with a state.
template <template <int> typename Alias>
struct FilterTag {
  template <int N>
  using Filter = Alias<N>;
};
template <int N>
using JosephFilter = KalmanFilter<N, Joseph>;
template <int N>
using ConventionalFilter = KalmanFilter<N, Conventional>;
template <int N>
using SquareRootFilter = KalmanFilter<N, SquareRoot>;

template <typename Use>
auto with_form(TableReader& table, const Use& use) {
  const std::string form = table.choice_or("form", {"joseph", "square_root", "conventional"}, "joseph");
  if (form == "square_root") return use(FilterTag<SquareRootFilter>{});
  if (form == "conventional") return use(FilterTag<ConventionalFilter>{});
  return use(FilterTag<JosephFilter>{});
}

template <int D>
PositionSensor<D> read_sensor(TableReader& tracker) {
  TableReader table = tracker.table("measurement");
  table.choice("model", {"position"});
  PositionSensor<D> sensor;
  if (table.has("sigma_m") == table.has("variance_m2"))
    throw table.error("", "has neither or both of sigma_m and variance_m2", "one of the two");
  sensor.sigma_m.setConstant(table.has("sigma_m") ? table.number("sigma_m", kPositive)
                                                  : std::sqrt(table.number("variance_m2", kPositive)));
  sensor.sigma_factor = table.number_or("sigma_factor", 1.0, kPositive);
  table.finish();
  return sensor;
}

template <int D>
PriorStart<2 * D> read_prior(TableReader& table) {
  constexpr int N = 2 * D;
  const std::vector<double> x = table.numbers("x", N);
  const std::vector<double> variance = table.numbers("variance", N, kPositive);
  PriorStart<N> prior;
  prior.x = Eigen::Map<const Eigen::Matrix<double, N, 1>>(x.data());
  prior.P = Eigen::Map<const Eigen::Matrix<double, N, 1>>(variance.data()).asDiagonal();
  prior.time_s = table.number_or("time_s", 0.0);
  return prior;
}

template <int D>
std::variant<PriorStart<2 * D>, TwoPointStart> read_start(TableReader& tracker) {
  TableReader table = tracker.table("start");
  if (table.choice("kind", {"prior", "two_point"}) == "two_point") {
    table.finish();
    return TwoPointStart{};
  }
  const PriorStart<2 * D> prior = read_prior<D>(table);
  table.finish();
  return prior;
}

FilterTrackerOptions read_options(TableReader& table, int measurements) {
  FilterTrackerOptions options;
  if (table.has("gate_probability"))
    options.gate_nis = chi_square_quantile(table.number("gate_probability", {0.5, 1.0 - 1e-12}), measurements);
  options.lost_after_s = table.number_or("lost_after_s", std::numeric_limits<double>::infinity(), kPositive);
  return options;
}

template <int D>
const StateSpace& kinematic_space() {
  return D == 1 ? line_space() : plane_space();
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
  return with_dimension(table, [&](auto dimension) {
    constexpr int D = decltype(dimension)::value;
    const Motion<D> motion = read_motion<D>(table);
    return with_form(table, [&](auto form) -> std::unique_ptr<Tracker> {
      using Filter = typename decltype(form)::template Filter<2 * D>;
      return std::make_unique<FilterTracker<Filter, Motion<D>, PositionSensor<D>>>(
          kinematic_space<D>(), motion, read_sensor<D>(table), read_start<D>(table), read_options(table, D));
    });
  });
}

std::unique_ptr<Tracker> make_kalman_bank(TableReader& table) {
  constexpr int D = 1;
  using Bank = FilterBank<KalmanFilter<2 * D>, Motion<D>, PositionSensor<D>>;
  const Motion<D> motion = read_motion<D>(table);
  const PositionSensor<D> sensor = read_sensor<D>(table);
  TableReader start = table.table("start");
  const PriorStart<2 * D> prior = read_prior<D>(start);
  start.finish();
  const std::vector<double> velocities = table.numbers("prior_velocities_mps");
  const std::vector<double> variance_factors = table.numbers("measurement_variance_factors", -1, kPositive);
  const std::vector<double> noise_factors = table.numbers("process_noise_factors", -1, kPositive);

  std::vector<Bank::Hypothesis> hypotheses;
  for (const double velocity_mps : velocities)
    for (const double variance_factor : variance_factors)
      for (const double noise_factor : noise_factors) {
        auto x = prior.x;
        x[1] = velocity_mps;
        PositionSensor<D> believed = sensor;
        believed.sigma_factor *= std::sqrt(variance_factor);
        hypotheses.push_back(
            {KalmanFilter<2 * D>(x, prior.P), Motion<D>{scaled(motion.noise, noise_factor)}, believed});
      }
  if (hypotheses.empty() || hypotheses.size() > 100000)
    throw table.error("prior_velocities_mps", "makes a bank of " + std::to_string(hypotheses.size()),
                      "1 to 100000 filters");
  return std::make_unique<Bank>(line_space(), std::move(hypotheses), prior.time_s);
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
