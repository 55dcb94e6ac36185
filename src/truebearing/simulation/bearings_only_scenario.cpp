#include "truebearing/simulation/bearings_only_scenario.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "truebearing/core/angle.hpp"
#include "truebearing/core/error.hpp"
#include "truebearing/measurement/bearing.hpp"
#include "truebearing/measurement/posterior_information.hpp"
#include "truebearing/motion/constant_velocity.hpp"

namespace truebearing {
namespace {

double drawn_guess(double truth, double sigma, double least, RandomStream& stream) {
  double guess = 0.0;
  do guess = truth + sigma * stream.normal();
  while (guess < least);
  return guess;
}

Eigen::Vector4d state_of(const SensorState& vessel) {
  Eigen::Vector4d x;
  x << vessel.position_m, vessel.velocity_mps;
  return x;
}

// [east, north, v_east, v_north, f0]; f0 is 0 where there is no source.
using SourceState = Eigen::Matrix<double, 5, 1>;

SourceState source_state(const SensorState& vessel, const std::optional<SourceTone>& tone, double time_s) {
  SourceState x;
  x << state_of(vessel), tone ? tone->at(time_s) : 0.0;
  return x;
}

BearingFrequency<> model_of(const BearingsOnlyParameters& parameters, const SensorState& own_ship) {
  const BearingsOnlyParameters::Sensor& sensor = parameters.sensor;
  return {own_ship.position_m,          own_ship.velocity_mps, sensor.sigma_rad,
          sensor.frequency_sigma_hz,    sensor.sound_mps,      true,
          parameters.source.has_value()};
}

}  // namespace

Recording empty_bearings(const BearingsOnlyParameters& parameters) {
  Recording recording;
  recording.measured = parameters.measured().components;
  recording.truth_space = &parameters.truth_space();
  recording.truth.resize(1);
  return recording;
}

void add_bearing(const BearingsOnlyParameters& parameters, double time_s, const VesselPath::State& own_ship,
                 const BoundedVector& target, RandomStream& scenario, RandomStream& noise, Recording& recording) {
  const BearingsOnlyParameters::Sensor& sensor = parameters.sensor;
  const Eigen::Vector2d offset_m = target.head<2>() - own_ship.state.position_m;
  Measurement taken;
  taken.time_s = time_s;
  taken.sensor = own_ship.state;
  if (sensor.reported) taken.sigma = BoundedVector::Constant(1, sensor.sigma_rad);
  // Drawn for missing values too: the noise of step k depends on k alone.
  const double error = sensor.sigma_rad * noise.normal();
  const bool outlier = noise.uniform() < sensor.outlier_share, dropped = noise.uniform() < sensor.dropout_share;
  const double bearing = std::atan2(offset_m.x(), offset_m.y()) + (outlier ? sensor.outlier_factor : 1.0) * error;
  const bool missing = dropped || (own_ship.turning && sensor.masked_in_turns) || !offset_m.allFinite();
  taken.z = BoundedVector::Constant(1, missing ? std::nan("") : wrap_pi(bearing));
  if (parameters.source) {
    const double heard_hz =
        model_of(parameters, own_ship.state).h(target.head<5>())(1) + sensor.frequency_sigma_hz * noise.normal();
    const bool unheard = noise.uniform() < sensor.frequency_dropout_share;
    taken.z.conservativeResize(2);
    taken.z[1] = missing || unheard ? std::nan("") : heard_hz;
    if (sensor.reported) taken.sigma = Eigen::Vector2d(sensor.sigma_rad, sensor.frequency_sigma_hz);
  }
  recording.counts.missing += is_unusable(recording, taken);
  if (recording.measurements.empty() && parameters.guess) {
    const BearingsOnlyParameters::Guess& guess = *parameters.guess;
    TargetGuess& drawn = taken.guess.emplace();
    drawn.range_m = drawn_guess(offset_m.norm(), guess.range_sigma_m, guess.least_range_m, scenario);
    drawn.range_sigma_m = guess.range_sigma_m;
    if (guess.speed_sigma_mps > 0.0) {
      drawn.speed_mps =
          drawn_guess(target.segment<2>(2).norm(), guess.speed_sigma_mps, guess.least_speed_mps, scenario);
      drawn.speed_sigma_mps = guess.speed_sigma_mps;
    }
  }
  recording.measurements.push_back(std::move(taken));
  recording.truth[0].x.push_back(target);
}

struct BearingsOnlyScenario::Draw {
  double period_s;
  int steps;
  VesselPath own_ship;
  VesselPath target;
  std::optional<SourceTone> tone;
};

BearingsOnlyScenario::Draw BearingsOnlyScenario::draw(RandomStream& stream) const {
  const double period_s = parameters_.period_s.draw(stream);
  const VesselPath own_ship = parameters_.own_ship.draw(Eigen::Vector2d::Zero(), stream);
  const double range_m = parameters_.range_m.draw(stream), bearing = radians(parameters_.bearing_deg.draw(stream));
  const VesselPath target = parameters_.target.draw({range_m * std::sin(bearing), range_m * std::cos(bearing)}, stream);
  std::optional<SourceTone> tone;
  if (parameters_.source) tone = parameters_.source->draw(stream);
  return {period_s, static_cast<int>(std::floor(parameters_.duration_s / period_s + 1e-9)) + 1, own_ship, target, tone};
}

bool BearingsOnlyScenario::accepts(const Draw& draw) const {
  const ConstantVelocity<2, ContinuousWhiteNoise> steady{};
  PosteriorInformation<4> information;
  const Eigen::Vector4d x0 = state_of(draw.target.at(0.0).state);
  Eigen::Vector2d last_m = Eigen::Vector2d::Zero();
  for (int k = 0; k < draw.steps; ++k) {
    const double time_s = k * draw.period_s;
    const auto [own_ship, turning] = draw.own_ship.at(time_s);
    last_m = draw.target.at(time_s).state.position_m - own_ship.position_m;
    if (last_m.norm() < parameters_.closest_m) return false;
    if (!parameters_.range_bound_percent) continue;
    if (k > 0) information.predict(steady.F(draw.period_s), steady.Q(draw.period_s));
    if (turning && parameters_.sensor.masked_in_turns) continue;
    information.update(Bearing<>{own_ship.position_m, own_ship.velocity_mps, parameters_.sensor.sigma_rad},
                       Eigen::Vector4d(steady.F(time_s) * x0));
  }
  if (!determines_position(draw)) return false;
  if (!parameters_.range_bound_percent) return true;
  const std::optional<Eigen::Matrix4d> P = information.covariance();
  if (!P) return false;
  const Eigen::Vector2d u = last_m.normalized();
  const double sigma_m = std::sqrt(u.dot(P->topLeftCorner<2, 2>() * u));
  return 100.0 * sigma_m < *parameters_.range_bound_percent * last_m.norm();
}

bool BearingsOnlyScenario::determines_position(const Draw& draw) const {
  if (!parameters_.position_bound) return true;
  const auto [most_m, at_s] = *parameters_.position_bound;
  const SourceState x0 = source_state(draw.target.at(0.0).state, draw.tone, 0.0);
  const ConstantVelocity<2, ContinuousWhiteNoise> steady{};
  // About the state at at_s, without the frequency where there is none.
  PosteriorInformation<Eigen::Dynamic> information(parameters_.source ? 5 : 4);
  for (int k = 0; k < draw.steps && k * draw.period_s <= at_s; ++k) {
    const double time_s = k * draw.period_s;
    const auto [own_ship, turning] = draw.own_ship.at(time_s);
    if (turning && parameters_.sensor.masked_in_turns) continue;
    SourceState x = x0;
    x.head<4>() = steady.F(time_s) * x0.head<4>();
    Eigen::Matrix<double, 5, Eigen::Dynamic> Phi =
        Eigen::Matrix<double, 5, 5>::Identity().leftCols(information.J().cols());
    Phi.topLeftCorner<4, 4>() = steady.F(time_s - at_s);
    information.update(model_of(parameters_, own_ship), x, Phi);
  }
  const std::optional<Eigen::MatrixXd> P = information.covariance();
  return P && std::sqrt(P->topLeftCorner<2, 2>().trace()) < most_m;
}

Recording BearingsOnlyScenario::simulate(const RunKey& key) const {
  constexpr int kMostDraws = 1000;
  RandomStream scenario(key, StreamId::scenario);
  RandomStream noise(key, StreamId::measurement);
  Draw run = draw(scenario);
  for (int draws = 1; !accepts(run); ++draws) {
    if (draws == kMostDraws)
      throw InputError("scenario", "accepts none of 1000 draws", "a wider [accept], or other distributions");
    run = draw(scenario);
  }

  Recording recording = empty_bearings(parameters_);
  const std::optional<VesselPath::Turn> turn = run.target.first_turn((run.steps - 1) * run.period_s);
  recording.truth[0].turns_at_s = turn ? turn->begin_s : std::numeric_limits<double>::infinity();
  if (parameters_.phases) recording.phases = parameters_.phases->names();
  for (int k = 0; k < run.steps; ++k) {
    const double time_s = k * run.period_s;
    const SourceState target = source_state(run.target.at(time_s).state, run.tone, time_s);
    add_bearing(parameters_, time_s, run.own_ship.at(time_s), target.head(truth_space().size()), scenario, noise,
                recording);
    if (parameters_.phases) recording.truth[0].phase.push_back(parameters_.phases->at(time_s, turn));
  }
  return recording;
}

namespace {

std::unique_ptr<Scenario> read(TableReader& table, bool with_source) {
  constexpr Range kShare{0.0, 1.0};
  BearingsOnlyParameters parameters;
  parameters.period_s = read_distribution(table, "period_s", {1e-3, 3600.0});
  parameters.duration_s = table.number("duration_s", {0.0, 1e6, true});
  TableReader own_ship = table.table("own_ship");
  parameters.own_ship = read_vessel(own_ship);
  own_ship.finish();
  TableReader target = table.table("target");
  parameters.range_m = read_distribution(target, "range_m", kPositive);
  parameters.bearing_deg = read_distribution(target, "bearing_deg");
  parameters.target = read_vessel(target);
  target.finish();

  TableReader sensor = table.table("sensor");
  parameters.sensor.sigma_rad = radians(sensor.number("bearing_sigma_deg", {0.0, 90.0, true}));
  parameters.sensor.dropout_share = sensor.number_or("dropout_share", 0.0, kShare);
  parameters.sensor.outlier_share = sensor.number_or("outlier_share", 0.0, kShare);
  parameters.sensor.outlier_factor = sensor.number_or("outlier_factor", 1.0, kPositive);
  parameters.sensor.masked_in_turns = sensor.boolean_or("masked_in_turns", false);
  parameters.sensor.reported = sensor.boolean_or("reported", true);
  if (with_source) {
    parameters.sensor.frequency_sigma_hz = sensor.number("frequency_sigma_hz", kPositive);
    parameters.sensor.frequency_dropout_share = sensor.number_or("frequency_dropout_share", 0.0, kShare);
    parameters.sensor.sound_mps = sensor.number_or("sound_mps", kSoundInWater_mps, kPositive);
    TableReader source = table.table("source");
    parameters.source = read_source(source);
    source.finish();
  }
  sensor.finish();

  if (auto guess = table.table_if_present("guess")) {
    BearingsOnlyParameters::Guess read;
    read.range_sigma_m = guess->number("range_sigma_m", kPositive);
    read.least_range_m = guess->number_or("least_range_m", 0.0, kNonNegative);
    read.speed_sigma_mps = guess->number_or("speed_sigma_mps", 0.0, kNonNegative);
    read.least_speed_mps = guess->number_or("least_speed_mps", 0.0, kNonNegative);
    guess->finish();
    parameters.guess = read;
  }
  if (auto accept = table.table_if_present("accept")) {
    parameters.closest_m = accept->number_or("closest_m", 0.0, kNonNegative);
    if (accept->has("range_bound_percent"))
      parameters.range_bound_percent = accept->number("range_bound_percent", kPositive);
    if (accept->has("position_bound_m") || accept->has("position_bound_at_s"))
      parameters.position_bound = {accept->number("position_bound_m", kPositive),
                                   accept->number("position_bound_at_s", {0.0, parameters.duration_s})};
    accept->finish();
  }
  if (auto phases = table.table_if_present("phases")) {
    parameters.phases = read_turn_phases(*phases);
    phases->finish();
  }
  return std::make_unique<BearingsOnlyScenario>(std::move(parameters));
}

}  // namespace

std::unique_ptr<Scenario> read_bearings_only_scenario(TableReader& table) {
  return read(table, false);
}

std::unique_ptr<Scenario> read_passive_sonar_scenario(TableReader& table) {
  return read(table, true);
}

}  // namespace truebearing
