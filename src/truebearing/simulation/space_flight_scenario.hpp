// SPDX-License-Identifier: Apache-2.0
// A flight in space, seen from a sensor at the origin, or on a vessel that begins there ([own_ship], vessel.hpp): a flight in the plane ([flight], planar_flight.hpp) with climbs
// above it ([climb], vertical_flight.hpp), from a place that is drawn ([start] east_m, north_m, up_m).
#pragma once

#include <memory>
#include <optional>
#include <utility>

#include "truebearing/simulation/look_schedule.hpp"
#include "truebearing/simulation/planar_flight.hpp"
#include "truebearing/simulation/scenario.hpp"
#include "truebearing/simulation/space_sensor.hpp"
#include "truebearing/simulation/vertical_flight.hpp"
#include "truebearing/simulation/vessel.hpp"

namespace truebearing {

struct SpaceFlightParameters {
  double period_s = 1.0;
  int steps = 1;                                         ///< at most: a flight may end before
  PlanarFlight flight;                                   ///< [flight]
  VerticalFlight vertical;                               ///< [climb]
  Distribution east_m = 0.0, north_m = 0.0, up_m = 0.0;  ///< [start]
  SpaceSensor sensor;                                    ///< [sensor]
  std::optional<VesselParameters> own_ship;              ///< [own_ship], at height 0; carries the sensor
  LookSchedule looks;                                    ///< [looks]
};

class SpaceFlightScenario final : public Scenario {
 public:
  explicit SpaceFlightScenario(SpaceFlightParameters parameters) : parameters_(std::move(parameters)) {}
  Recording simulate(const RunKey& key) const override;
  const StateSpace& truth_space() const override { return space_space(); }
  std::optional<Measured> measured() const override { return parameters_.sensor.output->measured; }
  bool reports_sigma() const override { return parameters_.sensor.reported; }
  const SpaceFlightParameters& parameters() const { return parameters_; }

 private:
  SpaceFlightParameters parameters_;
};

std::unique_ptr<Scenario> read_space_flight_scenario(TableReader& table);

}  // namespace truebearing
