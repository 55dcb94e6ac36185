// SPDX-License-Identifier: Apache-2.0
#include "truebearing/study/limit_trackers.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <limits>

#include "truebearing/simulation/bearings_only_scenario.hpp"
#include "truebearing/simulation/planar_flight_scenario.hpp"
#include "truebearing/study/measurement_kinds.hpp"
#include "truebearing/study/passive_sonar_configuration.hpp"
#include "truebearing/tracker/particle_limit.hpp"
#include "truebearing/tracker/polar_sensor.hpp"
#include "truebearing/tracker/position_sensor.hpp"
#include "truebearing/tracker/turn_limit.hpp"

namespace truebearing {
namespace {

constexpr double kLongestFlight_s = 3600.0;  // without a measurement

// A standard deviation that each run draws is of no use, but where each measurement reports its own.
std::unique_ptr<AnySensor> sensor_of_scenario(const TableReader& table, const PlanarSensor& sensor) {
  const auto refused = [&](const std::string& why) {
    return table.error("kind", "is \"particle_limit\", and the scenario's sensor " + why,
                       "measured positions, or ranges and bearings, with Gaussian noise that is known");
  };
  if (sensor.outlier_share > 0.0) throw refused("has outliers");
  if (sensor.false_share > 0.0) throw refused("has false plots");
  if (sensor.R_m2) throw refused("has correlated errors");
  if (!sensor.sigma_m.is_fixed() && !sensor.reported)
    throw refused("has a standard deviation that is drawn and not reported");
  const double sigma_m = sensor.sigma_m.quantile(0.5);
  if (sensor.output->name == "plane") return sensor_of(PositionSensor<2>{{sigma_m, sigma_m}});
  if (sensor.output->name == "range_bearing")
    return sensor_of(ConvertedSensor{PolarSensor{{sigma_m, sensor.further_sigma[0]}}});
  throw refused("has the output \"" + sensor.output->name + "\"");
}

std::uint64_t read_seed(TableReader& table) {
  return static_cast<std::uint64_t>(table.integer_or("seed", 1, 0, std::numeric_limits<std::int64_t>::max()));
}

// Of a source that turns at most once, after the batch estimate.
std::unique_ptr<Tracker> make_turn_limit(TableReader& table, const BearingsOnlyParameters& family) {
  const auto refused = [&](const std::string& why) {
    return table.error("kind", "is \"particle_limit\", and the scenario's " + why,
                       "a source of one frequency that turns once by an angle, and Gaussian noise");
  };
  if (!family.source) throw refused("target is no source");
  if (!family.source->changes.empty()) throw refused("source changes its frequency");
  if (family.target.random_turns || family.target.turns.size() != 1) throw refused("target does not turn once");
  const VesselParameters::Turn& turn = family.target.turns.front();
  if (turn.is_course || !(turn.angle_deg.quantile(0.0) >= 0.0))
    throw refused("target's turn is not by an angle of 0 or more");
  if (family.sensor.outlier_share > 0.0) throw refused("sensor has outliers");
  TurnLimitOptions options;
  options.turn = turn;
  options.hypotheses = static_cast<int>(table.integer_or("particles", options.hypotheses, 100, 1'000'000));
  options.seed = read_seed(table);
  if (!measures(table, "bearing_frequency"))
    throw table.error("measurement", "is of no source", "model = \"bearing_frequency\"");
  options.sensor = read_bearing_frequency_sensor(table);
  const double hand_over_s = table.number("hand_over_s", kNonNegative);
  if (turn.time_s.quantile(0.0) < hand_over_s)
    throw table.error("hand_over_s", fmt::format("is {}", hand_over_s),
                      fmt::format("a time before the first turn, {} s", turn.time_s.quantile(0.0)));
  return make_passive_sonar_with(table, std::make_unique<TurnLimit>(std::move(options)));
}

}  // namespace

std::unique_ptr<Tracker> make_particle_limit(TableReader& table, const Scenario& scenario) {
  if (const auto* encounters = dynamic_cast<const BearingsOnlyScenario*>(&scenario))
    return make_turn_limit(table, encounters->parameters());
  const auto* flights = dynamic_cast<const PlanarFlightScenario*>(&scenario);
  if (!flights)
    throw table.error("kind", "is \"particle_limit\", which knows planar flights and the turn of a source",
                      "a scenario of kind \"planar_flight\" or \"passive_sonar\"");
  const PlanarFlightParameters& family = flights->parameters();
  if (!family.sources.empty())
    throw table.error("kind", "is \"particle_limit\", which knows one sensor", "a scenario with one [scenario.sensor]");
  if (family.flight.intervals)
    throw table.error("kind", "is \"particle_limit\", which does not know flights of intervals",
                      "a scenario whose flights are legs and manoeuvres");
  ParticleLimitOptions options;
  options.flight = family.flight;
  options.particles = static_cast<int>(table.integer_or("particles", options.particles, 100, 1'000'000));
  options.seed = read_seed(table);
  options.flown_s = family.jitter ? family.jitter->margin() * family.period_s : 0.0;
  options.flight_s = std::min(family.steps * family.period_s, kLongestFlight_s);
  return std::make_unique<ParticleLimit>(sensor_of_scenario(table, family.sensor), std::move(options));
}

bool is_limited(const Scenario& scenario) {
  if (dynamic_cast<const BearingsOnlyScenario*>(&scenario)) return true;
  const auto* flights = dynamic_cast<const PlanarFlightScenario*>(&scenario);
  return flights && !flights->parameters().jitter;
}

bool are_one_family(const Scenario& a, const Scenario& b) {
  const auto* one = dynamic_cast<const PlanarFlightScenario*>(&a);
  const auto* other = dynamic_cast<const PlanarFlightScenario*>(&b);
  if (!one || !other) return false;
  const PlanarSensor &seen = one->parameters().sensor, &other_seen = other->parameters().sensor;
  return one->parameters().flight == other->parameters().flight && seen.output == other_seen.output &&
         seen.sigma_m == other_seen.sigma_m && seen.R_m2 == other_seen.R_m2 &&
         seen.further_sigma == other_seen.further_sigma && seen.outlier_share == other_seen.outlier_share &&
         seen.false_share == other_seen.false_share &&
         one->parameters().jitter.has_value() == other->parameters().jitter.has_value();
}

}  // namespace truebearing
