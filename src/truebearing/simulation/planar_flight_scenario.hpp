// A flight in the plane, seen from a site: as ground range from the site (output "range": line space, range and its
// rate) or as East and North from the site (output "plane"). The site stands off a random point of the track, square to
// the velocity there, at the distance drawn; another part of the track may pass nearer.
//
// With [jitter] the true and the measured position are those that a recorder would have kept, since recorded tracks are
// scored against recorded positions. The true velocity, and with it the range rate, is that of the flight itself.
#pragma once

#include <memory>
#include <optional>
#include <utility>

#include "truebearing/simulation/planar_flight.hpp"
#include "truebearing/simulation/recorder_jitter.hpp"
#include "truebearing/simulation/scenario.hpp"

namespace truebearing {

struct SitePlacement {
  Distribution closest_m = 0.0;
  double overflight_share = 0.0;  ///< probability that the distance is drawn from overflight_m instead
  Distribution overflight_m = 0.0;
};

struct PlanarFlightParameters {
  enum class Output { range, plane };

  Output output = Output::range;
  double period_s = 1.0;
  int steps = 1;
  PlanarFlight flight;                   ///< [flight]
  SitePlacement site;                    ///< [site]
  std::optional<RecorderJitter> jitter;  ///< [jitter]
  Distribution sigma_m = 1.0;            ///< [sensor] position_sigma_m, of the range or per axis
  bool reported = false;                 ///< [sensor] does a measurement carry its sigma?
};

class PlanarFlightScenario final : public Scenario {
 public:
  explicit PlanarFlightScenario(PlanarFlightParameters parameters) : parameters_(std::move(parameters)) {}
  Recording simulate(const RunKey& key) const override;
  const StateSpace& truth_space() const override;

 private:
  PlanarFlightParameters parameters_;
};

std::unique_ptr<Scenario> read_planar_flight_scenario(TableReader& table);

}  // namespace truebearing
