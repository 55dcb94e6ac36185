#include "truebearing/simulation/planar_flight_scenario.hpp"

#include <cmath>
#include <numeric>
#include <string>

#include "truebearing/core/angle.hpp"

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
    return track.col(placement.at_step - 1).head<2>() -
           range_m * Eigen::Vector2d(std::sin(bearing_rad), std::cos(bearing_rad));
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

Recording PlanarFlightScenario::simulate(const RunKey& key) const {
  RandomStream scenario(key, StreamId::scenario);
  RandomStream process(key, StreamId::process);
  RandomStream measurement(key, StreamId::measurement);

  const double sigma_m = parameters_.sensor.sigma_m.draw(scenario);
  const int margin = parameters_.jitter ? parameters_.jitter->margin() : 0;
  const FlownTrack whole = parameters_.flight.fly(parameters_.period_s, parameters_.steps + 2 * margin, scenario);
  Eigen::Matrix4Xd flown = whole.states.middleCols(margin, parameters_.steps);
  Eigen::Matrix2Xd recorded = flown.topRows<2>();
  if (parameters_.jitter)
    recorded = parameters_.jitter->record(whole.states, process).middleCols(margin, parameters_.steps);

  const Eigen::Vector2d site_m = std::visit(PlaceSite{flown, scenario}, parameters_.site);
  flown.topRows<2>().colwise() -= site_m;
  recorded.colwise() -= site_m;

  Recording recording;
  recording.measured = parameters_.sensor.measured().components;
  recording.truth_space = &truth_space();
  recording.truth.resize(1);
  if (parameters_.quiet_after_s) recording.phases = {"manoeuvre", "quiet"};
  for (int k = 0; k < parameters_.steps; ++k) {
    Eigen::Vector4d state;
    state << recorded.col(k), flown.col(k).tail<2>();
    recording.measurements.push_back(
        parameters_.sensor.measure((k + 1) * parameters_.period_s, state, sigma_m, measurement));
    BoundedVector x(truth_space().size());
    if (parameters_.sensor.is_range())
      x = range_truth(recorded.col(k), flown.col(k));
    else
      x = state;
    recording.truth[0].x.push_back(std::move(x));
    if (parameters_.quiet_after_s)
      recording.truth[0].phase.push_back(whole.since_manoeuvre_s[margin + k] > *parameters_.quiet_after_s ? 1 : 0);
  }
  return recording;
}

namespace {

PlanarFlight read_flight(TableReader flight) {
  // Shorter than this, a leg or a turn is none, and the programme of a flight would not end.
  constexpr Range kDuration{0.1, 1e6};

  PlanarFlight parameters;
  parameters.speed_mps = read_distribution(flight, "speed_mps", kPositive);
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

std::variant<SiteAtStart, SiteBesideTrack, SiteAtRange> read_site(std::optional<TableReader> site, int steps) {
  if (!site) return SiteAtStart{};
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
  return std::make_unique<PlanarFlightScenario>(std::move(parameters));
}

}  // namespace truebearing
