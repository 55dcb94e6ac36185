// SPDX-License-Identifier: Apache-2.0
#include "truebearing/simulation/planar_flight_scenario.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "truebearing/core/angle.hpp"
#include "truebearing/core/constants.hpp"

namespace truebearing {
namespace {

// Where the site is, for a track flown (4 x steps) from the origin.
struct PlaceSite {
  const Eigen::Matrix4Xd& track;
  RandomStream& stream;

  Eigen::Vector2d operator()(const SiteAtStart&) const { return Eigen::Vector2d::Zero(); }

  Eigen::Vector2d operator()(const SiteBesideTrack& placement) const {
    const bool overflight = stream.uniform() < placement.overflight_share;
    const double distance_m = (overflight ? placement.overflight_m : placement.closest_m).draw(stream);
    const auto k = static_cast<Eigen::Index>(stream.index(static_cast<std::uint64_t>(track.cols())));
    const double side = stream.uniform() < 0.5 ? -1.0 : 1.0;
    const Eigen::Vector2d along = track.col(k).tail<2>().normalized();
    return track.col(k).head<2>() + side * distance_m * Eigen::Vector2d(-along.y(), along.x());
  }

  Eigen::Vector2d operator()(const SiteAtRange& placement) const {
    const double range_m = placement.range_m.draw(stream);
    const double bearing_rad = stream.uniform(-kPi, kPi);
    const Eigen::Index at = std::min<Eigen::Index>(placement.at_step, track.cols()) - 1;
    return track.col(at).head<2>() - range_m * Eigen::Vector2d(std::sin(bearing_rad), std::cos(bearing_rad));
  }

  Eigen::Vector2d operator()(const SiteFromStart& placement) const {
    const double east_m = placement.east_m.draw(stream), north_m = placement.north_m.draw(stream);
    return track.col(0).head<2>() - Eigen::Vector2d(east_m, north_m);
  }
};

/// [range, range rate]: the range as recorded, the rate of the flight itself, both from the site at the origin.
Eigen::Vector2d range_truth(const Eigen::Vector2d& recorded_m, const Eigen::Vector4d& flown) {
  return {recorded_m.norm(), flown.tail<2>().dot(flown.head<2>().stableNormalized())};
}

}  // namespace

const StateSpace& PlanarFlightScenario::truth_space() const {
  return parameters_.sensor.is_range() ? line_space() : plane_space();
}

// A recorder keeps its own time, once per period from a while before the first look to a while after the last; in between
// its track is a straight line, wherever it is looked at.
PlanarFlightScenario::SeenFlight PlanarFlightScenario::fly(const std::vector<Look>& looks, RandomStream& scenario,
                                                           RandomStream& process) const {
  constexpr double kRounding = 1e-9;  // of a look at the recorder's own time, in periods
  const int margin = parameters_.jitter ? parameters_.jitter->margin() : 0;
  const double period_s = parameters_.period_s;
  const auto flight_time = [&](const Look& look) { return look.time_s - looks.front().time_s + margin * period_s; };

  std::vector<double> kept_s;  // by the recorder
  if (parameters_.jitter)
    for (int k = 0; kept_s.empty() || kept_s.back() < flight_time(looks.back()) + (margin - kRounding) * period_s; ++k)
      kept_s.push_back(k * period_s);
  std::vector<double> times_s = kept_s;
  for (const Look& look : looks) {
    const double time_s = flight_time(look), nearest_s = std::round(time_s / period_s) * period_s;
    if (!parameters_.jitter || std::abs(time_s - nearest_s) > kRounding * period_s) times_s.push_back(time_s);
  }
  std::sort(times_s.begin(), times_s.end());
  times_s.push_back(times_s.back() + period_s);  // what is drawn after a flight comes after its last look's period
  const FlownTrack track = parameters_.flight.fly(times_s, scenario);
  const auto column = [&](double time_s) {  // of the time nearest to it
    const auto after = std::lower_bound(times_s.begin(), times_s.end(), time_s - kRounding * period_s);
    return static_cast<Eigen::Index>(after - times_s.begin());
  };

  Eigen::Index count = 0;  // until the flight ends, and the first in any case
  for (const Look& look : looks) count += flight_time(look) <= track.end_s + kRounding * period_s;
  count = std::max<Eigen::Index>(count, 1);
  SeenFlight seen{Eigen::Matrix4Xd(4, count), Eigen::Matrix2Xd(2, count), Eigen::VectorXd(count)};
  for (Eigen::Index k = 0; k < count; ++k) {
    const Eigen::Index at = column(flight_time(looks[static_cast<std::size_t>(k)]));
    seen.flown.col(k) = track.states.col(at);
    seen.since_manoeuvre_s[k] = track.since_manoeuvre_s[at];
  }
  seen.recorded_m = seen.flown.topRows<2>();
  if (!parameters_.jitter) return seen;

  Eigen::Matrix4Xd kept(4, static_cast<Eigen::Index>(kept_s.size()));
  for (std::size_t k = 0; k < kept_s.size(); ++k)
    kept.col(static_cast<Eigen::Index>(k)) = track.states.col(column(kept_s[k]));
  const Eigen::Matrix2Xd recorded = parameters_.jitter->record(kept, process);
  for (Eigen::Index k = 0; k < count; ++k) {
    const double place = flight_time(looks[static_cast<std::size_t>(k)]) / period_s;
    const double before = std::floor(place + kRounding), part = std::max(place - before, 0.0);
    const auto at = static_cast<Eigen::Index>(before);
    seen.recorded_m.col(k) = recorded.col(at);
    if (part > kRounding) seen.recorded_m.col(k) += part * (recorded.col(at + 1) - recorded.col(at));
  }
  return seen;
}

Recording PlanarFlightScenario::simulate(const RunKey& key) const {
  RandomStream scenario(key, StreamId::scenario);
  RandomStream process(key, StreamId::process);
  RandomStream measurement(key, StreamId::measurement);

  const double sigma_m = parameters_.sensor.sigma_m.draw(scenario);
  const std::vector<Look> looks = parameters_.looks.draw(parameters_.period_s, parameters_.steps, key);
  const SeenFlight seen = fly(looks, scenario, process);
  Eigen::Matrix4Xd flown = seen.flown;
  Eigen::Matrix2Xd recorded = seen.recorded_m;

  const Eigen::Vector2d site_m = std::visit(PlaceSite{flown, scenario}, parameters_.site);
  flown.topRows<2>().colwise() -= site_m;
  recorded.colwise() -= site_m;

  Recording recording;
  recording.measured = parameters_.sensor.measured().components;
  recording.truth_space = &truth_space();
  recording.truth.resize(1);
  if (parameters_.quiet_after_s) recording.phases = {"manoeuvre", "quiet"};
  for (std::size_t k = 0; k < static_cast<std::size_t>(flown.cols()); ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    Eigen::Vector4d state;
    state << recorded.col(column), flown.col(column).tail<2>();
    Measurement taken = parameters_.sensor.measure(looks[k].time_s, state, sigma_m, measurement);
    if (!parameters_.looks.keeps(looks[k])) continue;
    if (!looks[k].seen) taken.z.setConstant(kNaN);
    recording.counts.missing += !looks[k].seen;
    recording.measurements.push_back(std::move(taken));
    BoundedVector x(truth_space().size());
    if (parameters_.sensor.is_range())
      x = range_truth(recorded.col(column), flown.col(column));
    else
      x = state;
    recording.truth[0].x.push_back(std::move(x));
    if (parameters_.quiet_after_s)
      recording.truth[0].phase.push_back(seen.since_manoeuvre_s[column] > *parameters_.quiet_after_s ? 1 : 0);
  }
  return recording;
}

namespace {

PlanarFlight read_flight(TableReader flight) {
  // Shorter than this, a leg or a turn is none, and the programme of a flight would not end.
  constexpr Range kDuration{0.1, 1e6};

  PlanarFlight parameters;
  parameters.speed_mps = read_distribution(flight, "speed_mps", kPositive);
  if (flight.has("intervals")) {
    FlightIntervals& intervals = parameters.intervals.emplace();
    intervals.count = read_distribution(flight, "intervals", {1.0, 1e4});
    intervals.interval_s = read_distribution(flight, "interval_s", kDuration);
    intervals.along_mps2 = read_distribution(flight, "along_mps2");
    intervals.across_mps2 = read_distribution(flight, "across_mps2");
    intervals.hold_s = flight.number_or("hold_s", 1.0, kDuration);
    flight.finish();
    return parameters;
  }
  if (flight.has("first_leg_s")) parameters.first_leg_s = read_distribution(flight, "first_leg_s", kNonNegative);
  parameters.leg_s = read_distribution(flight, "leg_s", kDuration);
  parameters.turn_s = read_distribution(flight, "turn_s", kDuration);
  parameters.turn_rate_degps = read_distribution(flight, "turn_rate_degps", kNonNegative);
  parameters.roll_in_s = read_distribution(flight, "roll_in_s", kNonNegative);
  parameters.acceleration_share = flight.number_or("acceleration_share", 0.0, {0.0, 1.0});
  if (parameters.acceleration_share > 0.0) {
    parameters.acceleration_s = read_distribution(flight, "acceleration_s", kDuration);
    parameters.acceleration_mps2 = read_distribution(flight, "acceleration_mps2", kNonNegative);
    parameters.lowest_speed_mps = flight.number_or("lowest_speed_mps", 0.0, kNonNegative);
    parameters.highest_speed_mps = flight.number_or("highest_speed_mps", 1e9, kPositive);
  }
  parameters.quiet_share = flight.number_or("quiet_share", 0.0, {0.0, 1.0});
  flight.finish();
  return parameters;
}

Site read_site(std::optional<TableReader> site, int steps) {
  if (!site) return SiteAtStart{};
  if (site->has("start_east_m")) {
    const SiteFromStart placement{read_distribution(*site, "start_east_m"), read_distribution(*site, "start_north_m")};
    site->finish();
    return placement;
  }
  if (site->has("range_m")) {
    const SiteAtRange placement{read_distribution(*site, "range_m", kNonNegative),
                                static_cast<int>(site->integer_or("at_step", 1, 1, steps))};
    site->finish();
    return placement;
  }
  SiteBesideTrack placement;
  placement.closest_m = read_distribution(*site, "closest_m", kNonNegative);
  placement.overflight_share = site->number_or("overflight_share", 0.0, {0.0, 1.0});
  if (placement.overflight_share > 0.0 || site->has("overflight_m"))
    placement.overflight_m = read_distribution(*site, "overflight_m", kNonNegative);
  site->finish();
  return placement;
}

RecorderJitter read_jitter(TableReader jitter) {
  constexpr double kRounding = 1e-6;
  RecorderJitter parameters;
  parameters.knots = jitter.numbers("knots", -1, {0.0, 1.0});
  const double sum = std::accumulate(parameters.knots.begin(), parameters.knots.end(), 0.0);
  if (std::abs(sum - 1.0) > kRounding) throw jitter.error("knots", "does not sum to 1", "probabilities");
  parameters.time_sigma_s = read_distribution(jitter, "time_sigma_s", kNonNegative);
  jitter.finish();
  return parameters;
}

}  // namespace

std::unique_ptr<Scenario> read_planar_flight_scenario(TableReader& table) {
  PlanarFlightParameters parameters;
  const std::string output = table.choice("output", planar_outputs());
  parameters.period_s = table.number("period_s", {0.0, 3600.0, true});
  parameters.steps = static_cast<int>(table.integer("steps", 1, 100'000));
  if (table.has("quiet_after_s")) parameters.quiet_after_s = table.number("quiet_after_s", kNonNegative);
  parameters.flight = read_flight(table.table("flight"));
  parameters.site = read_site(table.table_if_present("site"), parameters.steps);
  if (std::optional<TableReader> jitter = table.table_if_present("jitter")) parameters.jitter = read_jitter(*jitter);
  parameters.sensor = read_planar_sensor(table.table("sensor"), output);
  parameters.looks = read_look_schedule(table);
  return std::make_unique<PlanarFlightScenario>(std::move(parameters));
}

}  // namespace truebearing
