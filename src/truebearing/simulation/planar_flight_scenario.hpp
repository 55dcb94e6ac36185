// SPDX-License-Identifier: Apache-2.0
// A flight in the plane, seen from a site: as ground range from the site (output "range": line space, range and its
// rate), as East and North from the site (output "plane"), or as range and bearing from it (output "range_bearing").
// The site is placed by one of three rules: [site] closest_m puts it off a random point of the track, square to the
// velocity there, at the distance drawn (another part of the track may pass nearer); [site] range_m puts it at that
// range and a uniform bearing from the target's place at step at_step; [site] start_east_m and start_north_m put it where
// the flight begins so far East and North of it. Without [site] it is where the flight begins.
//
// In place of output, [sensor] and [looks], tables [sensors.NAME] are several sensors that look each in its own time.
//
// With [jitter] the true and the measured position are those that a recorder would have kept, since recorded tracks are
// scored against recorded positions. The true velocity, and with it the range rate, is that of the flight itself.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "truebearing/simulation/look_schedule.hpp"
#include "truebearing/simulation/planar_flight.hpp"
#include "truebearing/simulation/planar_sensor.hpp"
#include "truebearing/simulation/recorder_jitter.hpp"
#include "truebearing/simulation/scenario.hpp"

namespace truebearing {

struct SiteBesideTrack {
  Distribution closest_m = 0.0;
  double overflight_share = 0.0;  ///< probability that the distance is drawn from overflight_m instead
  Distribution overflight_m = 0.0;
};
struct SiteAtRange {
  Distribution range_m = 10000.0;
  int at_step = 1;  ///< counted from 1; the last where the flight ends before
};
struct SiteFromStart {
  Distribution east_m = 0.0, north_m = 0.0;  ///< of the flight's beginning, as seen from the site
};
struct SiteAtStart {};
/// One of several sensors.
struct PlanarSource {
  std::string name;
  PlanarSensor sensor;
  double period_s = 1.0;  ///< it looks at first_s, first_s + period_s, ...
  double first_s = 1.0;
  double missed = 0.0;                               ///< probability that a look sees nothing, and leaves no row
  Eigen::Vector2d site_m = Eigen::Vector2d::Zero();  ///< East and North of the scenario's site
  BoundedVector bias;                                ///< what it measures too much, in the units of z; or empty
};

using Site = std::variant<SiteAtStart, SiteBesideTrack, SiteAtRange, SiteFromStart>;

struct PlanarFlightParameters {
  double period_s = 1.0;
  int steps = 1;                         ///< at most: a flight may end before
  PlanarFlight flight;                   ///< [flight]
  Site site;                             ///< [site]
  std::optional<RecorderJitter> jitter;  ///< [jitter]
  PlanarSensor sensor;                   ///< [sensor]
  LookSchedule looks;                    ///< [looks]
  std::vector<PlanarSource> sources;     ///< [sensors.NAME], by name; empty where there is one
  /// Where given, steps are told apart for the report: "quiet" longer than this after a manoeuvre, else "manoeuvre".
  std::optional<double> quiet_after_s;
};

class PlanarFlightScenario final : public Scenario {
 public:
  explicit PlanarFlightScenario(PlanarFlightParameters parameters) : parameters_(std::move(parameters)) {}
  Recording simulate(const RunKey& key) const override;
  const StateSpace& truth_space() const override;
  std::optional<Measured> measured() const override;
  bool reports_sigma() const override { return parameters_.sensor.reported; }
  const PlanarFlightParameters& parameters() const { return parameters_; }

 private:
  /// A flight at the looks, one to a column: as flown (4 x looks), and where it was recorded (2 x looks).
  struct SeenFlight {
    Eigen::Matrix4Xd flown;
    Eigen::Matrix2Xd recorded_m;
    Eigen::VectorXd since_manoeuvre_s;
  };
  SeenFlight fly(const std::vector<Look>& looks, RandomStream& scenario, RandomStream& process) const;
  Recording begin_recording() const;
  Recording simulate_several(const RunKey& key) const;

  PlanarFlightParameters parameters_;
};

std::unique_ptr<Scenario> read_planar_flight_scenario(TableReader& table);

}  // namespace truebearing
