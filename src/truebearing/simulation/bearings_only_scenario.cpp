// SPDX-License-Identifier: Apache-2.0
#include "truebearing/simulation/bearings_only_scenario.hpp"

#include <cmath>
#include <limits>

#include "truebearing/core/angle.hpp"
#include "truebearing/core/error.hpp"

namespace truebearing {
namespace {

double drawn_guess(double truth, double sigma, double least, RandomStream& stream) {
  double guess = 0.0;
  do guess = truth + sigma * stream.normal();
  while (guess < least);
  return guess;
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
  Measurement taken = parameters.sensor.measure(time_s, own_ship, target, noise);
  recording.counts.missing += is_unusable(recording, taken);
  if (recording.measurements.empty() && parameters.guess) {
    const BearingsOnlyParameters::Guess& guess = *parameters.guess;
    TargetGuess& drawn = taken.guess.emplace();
    const double range_m = (target.head<2>() - own_ship.state.position_m).norm();
    drawn.range_m = drawn_guess(range_m, guess.range_sigma_m, guess.least_range_m, scenario);
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

Encounter BearingsOnlyScenario::draw(RandomStream& stream) const {
  const double period_s = parameters_.period_s.draw(stream);
  const VesselPath own_ship = parameters_.own_ship.draw(Eigen::Vector2d::Zero(), stream);
  const double range_m = parameters_.range_m.draw(stream), bearing = radians(parameters_.bearing_deg.draw(stream));
  const VesselPath target = parameters_.target.draw({range_m * std::sin(bearing), range_m * std::cos(bearing)}, stream);
  std::optional<SourceTone> tone;
  if (parameters_.source) tone = parameters_.source->draw(stream);
  return {period_s, static_cast<int>(std::floor(parameters_.duration_s / period_s + 1e-9)) + 1, own_ship, target, tone};
}

Recording BearingsOnlyScenario::simulate(const RunKey& key) const {
  constexpr int kMostDraws = 1000;
  RandomStream scenario(key, StreamId::scenario);
  RandomStream noise(key, StreamId::measurement);
  Encounter run = draw(scenario);
  for (int draws = 1; !parameters_.accept.accepts(run, parameters_.sensor); ++draws) {
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
    add_bearing(parameters_, time_s, run.own_ship.at(time_s), run.target_at(time_s), scenario, noise, recording);
    if (parameters_.phases) recording.truth[0].phase.push_back(parameters_.phases->at(time_s, turn));
  }
  return recording;
}

namespace {

std::unique_ptr<Scenario> read(TableReader& table, bool with_source) {
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

  parameters.sensor = read_sonar(table.table("sensor"), with_source);
  if (with_source) {
    TableReader source = table.table("source");
    parameters.source = read_source(source);
    source.finish();
  }

  if (auto guess = table.table_if_present("guess")) {
    BearingsOnlyParameters::Guess read;
    read.range_sigma_m = guess->number("range_sigma_m", kPositive);
    read.least_range_m = guess->number_or("least_range_m", 0.0, kNonNegative);
    read.speed_sigma_mps = guess->number_or("speed_sigma_mps", 0.0, kNonNegative);
    read.least_speed_mps = guess->number_or("least_speed_mps", 0.0, kNonNegative);
    guess->finish();
    parameters.guess = read;
  }
  if (auto accept = table.table_if_present("accept"))
    parameters.accept = read_accepted_encounters(std::move(*accept), parameters.duration_s);
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
