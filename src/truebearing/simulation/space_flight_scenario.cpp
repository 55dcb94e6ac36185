// SPDX-License-Identifier: Apache-2.0
#include "truebearing/simulation/space_flight_scenario.hpp"

#include <string>
#include <vector>

#include "truebearing/core/constants.hpp"

namespace truebearing {

Recording SpaceFlightScenario::simulate(const RunKey& key) const {
  RandomStream scenario(key, StreamId::scenario);
  RandomStream measurement(key, StreamId::measurement);
  const SpaceFlightParameters& p = parameters_;

  const double east_m = p.east_m.draw(scenario), north_m = p.north_m.draw(scenario), up_m = p.up_m.draw(scenario);
  const std::vector<Look> looks = p.looks.draw(p.period_s, p.steps, key);
  std::vector<double> times_s;
  for (const Look& look : looks) times_s.push_back(look.time_s - looks.front().time_s);
  const Eigen::Matrix2Xd height = p.vertical.fly(times_s, up_m, scenario);
  const FlownTrack track = p.flight.fly(times_s, scenario);
  std::optional<VesselPath> own_ship;
  if (p.own_ship) own_ship = p.own_ship->draw(Eigen::Vector2d::Zero(), scenario);

  Recording recording;
  recording.measured = p.sensor.output->measured.components;
  recording.truth_space = &truth_space();
  recording.truth.resize(1);
  for (std::size_t k = 0; k < looks.size() && (k == 0 || times_s[k] <= track.end_s); ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    const Eigen::Vector4d plane = track.states.col(column);
    SpaceOutput::State x;
    x << east_m + plane[0], north_m + plane[1], height(0, column), plane[2], plane[3], height(1, column);
    SpaceOutput::State seen = x;  // from the sensor
    std::optional<SensorState> from;
    if (own_ship) {
      from = own_ship->at(times_s[k]).state;
      seen.head<2>() -= from->position_m;
      seen.segment<2>(3) -= from->velocity_mps;
    }
    Measurement taken = p.sensor.measure(looks[k].time_s, seen, measurement);
    if (from) taken.sensor = from;
    if (!p.looks.keeps(looks[k])) continue;
    if (!looks[k].seen) taken.z.setConstant(kNaN);
    recording.counts.missing += !looks[k].seen;
    recording.measurements.push_back(std::move(taken));
    recording.truth[0].x.emplace_back(x);
  }
  return recording;
}

std::unique_ptr<Scenario> read_space_flight_scenario(TableReader& table) {
  constexpr Range kDuration{0.1, 1e6};
  SpaceFlightParameters parameters;
  const std::string output = table.choice("output", space_outputs());
  parameters.period_s = table.number("period_s", {0.0, 3600.0, true});
  parameters.steps = static_cast<int>(table.integer("steps", 1, 100'000));
  parameters.flight = read_planar_flight(table.table("flight"));
  if (std::optional<TableReader> climb = table.table_if_present("climb")) {
    parameters.vertical.level_s = read_distribution(*climb, "level_s", kDuration);
    parameters.vertical.climb_s = read_distribution(*climb, "climb_s", kDuration);
    parameters.vertical.climb_mps = read_distribution(*climb, "climb_mps", kNonNegative);
    parameters.vertical.acceleration_mps2 = read_distribution(*climb, "acceleration_mps2", kPositive);
    climb->finish();
  }
  TableReader start = table.table("start");
  parameters.east_m = read_distribution(start, "east_m");
  parameters.north_m = read_distribution(start, "north_m");
  parameters.up_m = read_distribution(start, "up_m");
  start.finish();
  parameters.sensor = read_space_sensor(table.table("sensor"), output);
  parameters.looks = read_look_schedule(table);
  if (std::optional<TableReader> own_ship = table.table_if_present("own_ship")) {
    if (output == "space")
      throw table.error("own_ship", "carries a sensor of positions, which are the same from anywhere",
                        "output = \"range_bearing_elevation\" or \"bearing_elevation\"");
    parameters.own_ship = read_vessel(*own_ship);
    own_ship->finish();
  }
  return std::make_unique<SpaceFlightScenario>(std::move(parameters));
}

}  // namespace truebearing
