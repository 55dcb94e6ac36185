#include "truebearing/simulation/planar_flight_scenario.hpp"

#include <cmath>
#include <numeric>

namespace truebearing {
namespace {

using Output = PlanarFlightParameters::Output;

Eigen::Vector2d place_site(const SitePlacement& placement, const Eigen::Matrix4Xd& track, RandomStream& stream) {
  const bool overflight = stream.uniform() < placement.overflight_share;
  const double distance_m = (overflight ? placement.overflight_m : placement.closest_m).draw(stream);
  const auto k = static_cast<Eigen::Index>(stream.index(static_cast<std::uint64_t>(track.cols())));
  const double side = stream.uniform() < 0.5 ? -1.0 : 1.0;
  const Eigen::Vector2d along = track.col(k).tail<2>().normalized();
  return track.col(k).head<2>() + side * distance_m * Eigen::Vector2d(-along.y(), along.x());
}

/// [range, range rate]: the range as recorded, the rate of the flight itself, both from the site at the origin.
Eigen::Vector2d range_truth(const Eigen::Vector2d& recorded_m, const Eigen::Vector4d& flown) {
  return {recorded_m.norm(), flown.tail<2>().dot(flown.head<2>().stableNormalized())};
}

}  // namespace

const StateSpace& PlanarFlightScenario::truth_space() const {
  return parameters_.output == Output::range ? line_space() : plane_space();
}

Recording PlanarFlightScenario::simulate(const RunKey& key) const {
  RandomStream scenario(key, StreamId::scenario);
  RandomStream process(key, StreamId::process);
  RandomStream measurement(key, StreamId::measurement);

  const double sigma_m = parameters_.sigma_m.draw(scenario);
  const int margin = parameters_.jitter ? parameters_.jitter->margin() : 0;
  const Eigen::Matrix4Xd whole = parameters_.flight.fly(parameters_.period_s, parameters_.steps + 2 * margin, scenario);
  Eigen::Matrix4Xd flown = whole.middleCols(margin, parameters_.steps);
  Eigen::Matrix2Xd recorded = flown.topRows<2>();
  if (parameters_.jitter) recorded = parameters_.jitter->record(whole, process).middleCols(margin, parameters_.steps);

  const Eigen::Vector2d site_m = place_site(parameters_.site, flown, scenario);
  flown.topRows<2>().colwise() -= site_m;
  recorded.colwise() -= site_m;

  const bool range = parameters_.output == Output::range;
  Recording recording;
  recording.measured = range ? std::vector<std::string>{"position_m"} : std::vector<std::string>{"east_m", "north_m"};
  recording.truth_space = &truth_space();
  recording.truth.resize(1);
  for (int k = 0; k < parameters_.steps; ++k) {
    BoundedVector x(range ? 2 : 4);
    if (range)
      x = range_truth(recorded.col(k), flown.col(k));
    else
      x << recorded.col(k), flown.col(k).tail<2>();
    Measurement taken;
    taken.time_s = (k + 1) * parameters_.period_s;
    taken.z = x.head(x.size() / 2);
    for (double& value : taken.z) value += sigma_m * measurement.normal();
    if (parameters_.reported) taken.sigma = BoundedVector::Constant(taken.z.size(), sigma_m);
    recording.measurements.push_back(std::move(taken));
    recording.truth[0].x.push_back(std::move(x));
  }
  return recording;
}

std::unique_ptr<Scenario> read_planar_flight_scenario(TableReader& table) {
  // Shorter than this, a leg or a turn is none, and the programme of a flight would not end.
  constexpr Range kDuration{0.1, 1e6};

  PlanarFlightParameters parameters;
  parameters.output = table.choice("output", {"range", "plane"}) == "range" ? Output::range : Output::plane;
  parameters.period_s = table.number("period_s", {0.0, 3600.0, true});
  parameters.steps = static_cast<int>(table.integer("steps", 1, 100'000));

  TableReader flight = table.table("flight");
  parameters.flight.speed_mps = read_distribution(flight, "speed_mps", kPositive);
  parameters.flight.leg_s = read_distribution(flight, "leg_s", kDuration);
  parameters.flight.turn_s = read_distribution(flight, "turn_s", kDuration);
  parameters.flight.turn_rate_degps = read_distribution(flight, "turn_rate_degps", kNonNegative);
  parameters.flight.roll_in_s = read_distribution(flight, "roll_in_s", kNonNegative);
  flight.finish();

  TableReader site = table.table("site");
  parameters.site.closest_m = read_distribution(site, "closest_m", kNonNegative);
  parameters.site.overflight_share = site.number_or("overflight_share", 0.0, {0.0, 1.0});
  if (parameters.site.overflight_share > 0.0 || site.has("overflight_m"))
    parameters.site.overflight_m = read_distribution(site, "overflight_m", kNonNegative);
  site.finish();

  if (std::optional<TableReader> jitter = table.table_if_present("jitter")) {
    constexpr double kRounding = 1e-6;
    parameters.jitter.emplace();
    std::vector<double>& knots = parameters.jitter->knots;
    knots = jitter->numbers("knots", -1, {0.0, 1.0});
    const double sum = std::accumulate(knots.begin(), knots.end(), 0.0);
    if (std::abs(sum - 1.0) > kRounding) throw jitter->error("knots", "does not sum to 1", "probabilities");
    parameters.jitter->time_sigma_s = read_distribution(*jitter, "time_sigma_s", kNonNegative);
    jitter->finish();
  }

  TableReader sensor = table.table("sensor");
  parameters.sigma_m = read_distribution(sensor, "position_sigma_m", kPositive);
  parameters.reported = sensor.boolean_or("reported", false);
  sensor.finish();
  return std::make_unique<PlanarFlightScenario>(std::move(parameters));
}

}  // namespace truebearing
