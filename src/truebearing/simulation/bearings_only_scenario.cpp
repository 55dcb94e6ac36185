#include "truebearing/simulation/bearings_only_scenario.hpp"

#include <algorithm>
#include <cmath>

#include "truebearing/core/angle.hpp"
#include "truebearing/core/error.hpp"
#include "truebearing/measurement/bearing.hpp"
#include "truebearing/measurement/fisher_information.hpp"

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

Eigen::Matrix4d transition(double t) {
  Eigen::Matrix4d F = Eigen::Matrix4d::Identity();
  F(0, 2) = F(1, 3) = t;
  return F;
}

}  // namespace

Recording empty_bearings() {
  Recording recording;
  recording.measured = {"bearing_deg"};
  recording.truth_space = &plane_space();
  recording.truth.resize(1);
  return recording;
}

void add_bearing(const BearingsOnlyParameters& parameters, double time_s, const VesselPath::State& own_ship,
                 const Eigen::Vector4d& target, RandomStream& scenario, RandomStream& noise, Recording& recording) {
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
  recording.counts.missing += missing;
  if (recording.measurements.empty() && parameters.guess) {
    const BearingsOnlyParameters::Guess& guess = *parameters.guess;
    TargetGuess& drawn = taken.guess.emplace();
    drawn.range_m = drawn_guess(offset_m.norm(), guess.range_sigma_m, guess.least_range_m, scenario);
    drawn.range_sigma_m = guess.range_sigma_m;
    if (guess.speed_sigma_mps > 0.0) {
      drawn.speed_mps = drawn_guess(target.tail<2>().norm(), guess.speed_sigma_mps, guess.least_speed_mps, scenario);
      drawn.speed_sigma_mps = guess.speed_sigma_mps;
    }
  }
  recording.measurements.push_back(std::move(taken));
  recording.truth[0].x.emplace_back(target);
}

struct BearingsOnlyScenario::Draw {
  double period_s;
  int steps;
  VesselPath own_ship;
  VesselPath target;
};

BearingsOnlyScenario::Draw BearingsOnlyScenario::draw(RandomStream& stream) const {
  const double period_s = parameters_.period_s.draw(stream);
  const VesselPath own_ship = parameters_.own_ship.draw(Eigen::Vector2d::Zero(), stream);
  const double range_m = parameters_.range_m.draw(stream), bearing = radians(parameters_.bearing_deg.draw(stream));
  const VesselPath target = parameters_.target.draw({range_m * std::sin(bearing), range_m * std::cos(bearing)}, stream);
  return {period_s, static_cast<int>(std::floor(parameters_.duration_s / period_s + 1e-9)) + 1, own_ship, target};
}

bool BearingsOnlyScenario::accepts(const Draw& draw) const {
  Eigen::Matrix4d information = Eigen::Matrix4d::Zero();
  const Eigen::Vector4d x0 = state_of(draw.target.at(0.0).state);
  double end_s = 0.0;
  Eigen::Vector2d last_m = Eigen::Vector2d::Zero();
  for (int k = 0; k < draw.steps; ++k) {
    end_s = k * draw.period_s;
    const auto [own_ship, turning] = draw.own_ship.at(end_s);
    last_m = draw.target.at(end_s).state.position_m - own_ship.position_m;
    if (last_m.norm() < parameters_.closest_m) return false;
    if (turning && parameters_.sensor.masked_in_turns) continue;
    const Bearing<> model{own_ship.position_m, own_ship.velocity_mps, parameters_.sensor.sigma_rad};
    const Eigen::Matrix4d Phi = transition(end_s);
    information += fisher_information(model, Eigen::Vector4d(Phi * x0), Phi);
  }
  if (!parameters_.range_bound_percent) return true;
  // The range's gradient at the end, carried back to time 0 where the information is; scaled to a unit diagonal, since
  // its components differ by the square of the time.
  Eigen::Vector4d u = Eigen::Vector4d::Zero();
  u.head<2>() = last_m.normalized();
  const Eigen::Vector4d scale = information.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::Vector4d g = scale.asDiagonal() * transition(end_s).transpose() * u;
  const Eigen::LDLT<Eigen::Matrix4d> scaled(scale.asDiagonal() * information * scale.asDiagonal());
  constexpr double kRounding = 1e-13;  // what is left of the information where there is none
  if (!(scaled.vectorD().minCoeff() > kRounding)) return false;
  return 100.0 * std::sqrt(g.dot(scaled.solve(g))) < *parameters_.range_bound_percent * last_m.norm();
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

  Recording recording = empty_bearings();
  for (int k = 0; k < run.steps; ++k) {
    const double time_s = k * run.period_s;
    add_bearing(parameters_, time_s, run.own_ship.at(time_s), state_of(run.target.at(time_s).state), scenario, noise,
                recording);
  }
  return recording;
}

std::unique_ptr<Scenario> read_bearings_only_scenario(TableReader& table) {
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
    accept->finish();
  }
  return std::make_unique<BearingsOnlyScenario>(std::move(parameters));
}

}  // namespace truebearing
