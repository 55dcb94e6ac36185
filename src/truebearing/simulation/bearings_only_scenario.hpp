// SPDX-License-Identifier: Apache-2.0
// Bearings of a target from an own ship that manoeuvres: target-motion analysis. Vessels sail at constant speed with
// turns (vessel.hpp); the target begins at a range and bearing from own ship, which begins at the origin. In passive
// sonar the target is a source (source.hpp) besides, whose frequency is heard too, and the truth ends in the frequency
// that it radiates. A family may accept some of its draws only (accepted_encounters.hpp).
#pragma once

#include <memory>
#include <optional>
#include <utility>

#include "truebearing/simulation/accepted_encounters.hpp"
#include "truebearing/simulation/scenario.hpp"
#include "truebearing/simulation/sonar.hpp"
#include "truebearing/simulation/source.hpp"
#include "truebearing/simulation/turn_phases.hpp"
#include "truebearing/simulation/vessel.hpp"

namespace truebearing {

struct BearingsOnlyParameters {
  Distribution period_s = 4.0;  ///< samples at 0, period, ... duration
  double duration_s = 0.0;
  VesselParameters own_ship;
  VesselParameters target;
  Distribution range_m = 1.0;      ///< of the target at time 0
  Distribution bearing_deg = 0.0;  ///< of the target at time 0

  Sonar sensor;
  std::optional<SourceParameters> source;  ///< whose frequency is measured; none: bearings only
  std::optional<TurnPhases> phases;        ///< of the target, that the recording tells apart

  /// The first measurement carries a guess of range, and of speed, that is as wrong as this; drawn again where it is
  /// less than the least.
  struct Guess {
    double range_sigma_m = 0.0;
    double least_range_m = 0.0;
    double speed_sigma_mps = 0.0;  ///< 0: no guess of the speed
    double least_speed_mps = 0.0;
  };
  std::optional<Guess> guess;

  AcceptedEncounters accept;

  const StateSpace& truth_space() const { return source ? plane_frequency_space() : plane_space(); }
  Measured measured() const { return source ? Measured::bearing_frequency() : Measured::bearing(); }
};

/// A recording of what the sensor measures, with its truth and no step yet.
Recording empty_bearings(const BearingsOnlyParameters& parameters);
/// Adds one to it: the bearing, and the frequency of a source, of a target in state [east, north, v_east, v_north] (and
/// frequency) from own ship, with the sensor's noise from `noise` and, to the first, the guess from `scenario`. What an
/// unknown component of the state leaves unknown is missing.
void add_bearing(const BearingsOnlyParameters& parameters, double time_s, const VesselPath::State& own_ship,
                 const BoundedVector& target, RandomStream& scenario, RandomStream& noise, Recording& recording);

class BearingsOnlyScenario final : public Scenario {
 public:
  explicit BearingsOnlyScenario(BearingsOnlyParameters parameters) : parameters_(std::move(parameters)) {}
  /// Throws InputError where a thousand draws were not accepted.
  Recording simulate(const RunKey& key) const override;
  const StateSpace& truth_space() const override { return parameters_.truth_space(); }
  std::optional<Measured> measured() const override { return parameters_.measured(); }
  bool reports_sigma() const override { return parameters_.sensor.reported; }
  const BearingsOnlyParameters& parameters() const { return parameters_; }

 private:
  Encounter draw(RandomStream& stream) const;

  BearingsOnlyParameters parameters_;
};

std::unique_ptr<Scenario> read_bearings_only_scenario(TableReader& table);
/// The same with a table [source].
std::unique_ptr<Scenario> read_passive_sonar_scenario(TableReader& table);

}  // namespace truebearing
