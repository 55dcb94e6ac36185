// SPDX-License-Identifier: Apache-2.0
#include "truebearing/simulation/planar_flight_scenario.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
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
  return parameters_.sources.empty() && parameters_.sensor.is_range() ? line_space() : plane_space();
}

std::optional<Measured> PlanarFlightScenario::measured() const {
  if (parameters_.sources.empty()) return parameters_.sensor.measured();
  std::vector<Source> sources;
  for (const PlanarSource& source : parameters_.sources)
    sources.push_back({source.name, source.sensor.measured().components});
  return Measured::several(std::move(sources));
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
  times_s.erase(std::unique(times_s.begin(), times_s.end()), times_s.end());  // of sensors that look at once
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

Recording PlanarFlightScenario::begin_recording() const {
  const Measured all = *measured();
  Recording recording;
  recording.measured = all.components;
  recording.sources = all.sources;
  recording.truth_space = &truth_space();
  recording.truth.resize(1);
  if (parameters_.quiet_after_s) recording.phases = {"manoeuvre", "quiet"};
  return recording;
}

Recording PlanarFlightScenario::simulate(const RunKey& key) const {
  if (!parameters_.sources.empty()) return simulate_several(key);
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

  Recording recording = begin_recording();
  const auto steps = static_cast<std::size_t>(flown.cols());
  recording.measurements.reserve(steps);
  recording.truth[0].x.reserve(steps);
  for (std::size_t k = 0; k < steps; ++k) {
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

// Looks of all sensors in the order of their times; of one time, of their names.
Recording PlanarFlightScenario::simulate_several(const RunKey& key) const {
  RandomStream scenario(key, StreamId::scenario);
  RandomStream process(key, StreamId::process);
  RandomStream measurement(key, StreamId::measurement);
  RandomStream schedule(key, StreamId::schedule);

  std::vector<std::pair<double, std::size_t>> times;  // and whose look it is
  std::vector<double> sigma_m;
  const double end_s = parameters_.period_s * parameters_.steps;
  for (std::size_t i = 0; i < parameters_.sources.size(); ++i) {
    const PlanarSource& source = parameters_.sources[i];
    sigma_m.push_back(source.sensor.sigma_m.draw(scenario));
    const double last = std::floor((end_s - source.first_s) / source.period_s + 1e-9);
    for (double k = 0.0; k <= last; k += 1.0)
      if (source.missed == 0.0 || schedule.uniform() >= source.missed)
        times.emplace_back(source.first_s + k * source.period_s, i);
  }
  std::sort(times.begin(), times.end());
  if (times.empty()) times.emplace_back(parameters_.sources.front().first_s, 0);
  std::vector<Look> looks;
  for (const auto& [time_s, source] : times) looks.push_back({time_s, true});

  const SeenFlight seen = fly(looks, scenario, process);
  const Eigen::Vector2d site_m = std::visit(PlaceSite{seen.flown, scenario}, parameters_.site);
  const bool stand_apart = std::any_of(parameters_.sources.begin(), parameters_.sources.end(),
                                       [](const PlanarSource& source) { return !source.site_m.isZero(); });
  Recording recording = begin_recording();
  for (Eigen::Index k = 0; k < seen.flown.cols(); ++k) {
    const auto& [time_s, place] = times[static_cast<std::size_t>(k)];
    const PlanarSource& source = parameters_.sources[place];
    Eigen::Vector4d state;
    state << seen.recorded_m.col(k) - site_m, seen.flown.col(k).tail<2>();
    Eigen::Vector4d from_sensor = state;
    from_sensor.head<2>() -= source.site_m;
    Measurement taken = source.sensor.measure(time_s, from_sensor, sigma_m[place], measurement);
    taken.source = static_cast<int>(place);
    if (stand_apart) taken.sensor = SensorState{source.site_m, Eigen::Vector2d::Zero()};
    if (source.bias.size() > 0) taken.z += source.bias;
    if (const int bearing = source.sensor.output->bearing; bearing >= 0) taken.z[bearing] = wrap_pi(taken.z[bearing]);
    recording.measurements.push_back(std::move(taken));
    recording.truth[0].x.push_back(state);
    if (parameters_.quiet_after_s)
      recording.truth[0].phase.push_back(seen.since_manoeuvre_s[k] > *parameters_.quiet_after_s ? 1 : 0);
  }
  return recording;
}

namespace {

PlanarSource read_source(const std::string& name, TableReader table) {
  constexpr Range kPeriod{1e-3, 3600.0};
  PlanarSource source;
  source.name = name;
  std::vector<std::string> outputs = planar_outputs();
  std::erase(outputs, "range");  // of a space of its own
  const std::string output = table.choice("output", outputs);
  source.period_s = table.number("period_s", kPeriod);
  source.first_s = table.number_or("first_s", source.period_s, kNonNegative);
  source.missed = table.number_or("missed", 0.0, {0.0, 1.0});
  if (table.has("site_m")) source.site_m = Eigen::Map<const Eigen::Vector2d>(table.numbers("site_m", 2).data());
  const std::vector<std::string> components = planar_output(output).measured.components;
  if (table.has("bias")) {
    const std::vector<double> bias = table.numbers("bias", static_cast<int>(components.size()));
    source.bias.resize(static_cast<Eigen::Index>(bias.size()));
    for (std::size_t i = 0; i < bias.size(); ++i)
      source.bias[static_cast<Eigen::Index>(i)] = components[i].ends_with("_deg") ? radians(bias[i]) : bias[i];
  }
  source.sensor = read_planar_sensor(std::move(table), output);
  return source;
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
  std::optional<TableReader> sources = table.table_if_present("sensors");
  const std::string output = sources ? "plane" : table.choice("output", planar_outputs());
  parameters.period_s = table.number("period_s", {0.0, 3600.0, true});
  parameters.steps = static_cast<int>(table.integer("steps", 1, 100'000));
  if (table.has("quiet_after_s")) parameters.quiet_after_s = table.number("quiet_after_s", kNonNegative);
  parameters.flight = read_planar_flight(table.table("flight"));
  parameters.site = read_site(table.table_if_present("site"), parameters.steps);
  if (std::optional<TableReader> jitter = table.table_if_present("jitter")) parameters.jitter = read_jitter(*jitter);
  if (sources) {
    std::vector<std::string> names = sources->keys();
    std::sort(names.begin(), names.end());
    constexpr double kMostLooks = 1e6;  // of a sensor in a run
    for (const std::string& name : names) {
      parameters.sources.push_back(read_source(name, sources->table(name)));
      if (parameters.period_s * parameters.steps > kMostLooks * parameters.sources.back().period_s)
        throw sources->error(name, "looks too often for so long a run", fmt::format("at most {:g} looks", kMostLooks));
    }
    sources->finish();
    if (names.empty()) throw table.error("sensors", "names none", "tables [scenario.sensors.NAME]");
  } else {
    parameters.sensor = read_planar_sensor(table.table("sensor"), output);
    parameters.looks = read_look_schedule(table);
  }
  const auto tells_bearing = [](const PlanarSource& source) { return source.sensor.output->bearing >= 0; };
  if (std::holds_alternative<SiteAtStart>(parameters.site) &&
      (parameters.sensor.output->bearing >= 0 ||
       std::any_of(parameters.sources.begin(), parameters.sources.end(), tells_bearing)))
    throw table.error("site", "is missing, and targets would begin at the sensor",
                      "a table with range_m, or start_east_m and start_north_m");
  return std::make_unique<PlanarFlightScenario>(std::move(parameters));
}

}  // namespace truebearing
