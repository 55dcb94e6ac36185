// Bearings of a target from an own ship that manoeuvres: target-motion analysis. Vessels sail at constant speed with
// turns (vessel.hpp); the target begins at a range and bearing from own ship, which begins at the origin. Noise is
// Gaussian, with dropouts and outliers where asked for; while own ship turns, bearings may be missing.
//
// A family may accept some of its draws only: those whose target never comes too close, and those whose range the
// bearings determine by the end (its Cramer-Rao bound, as if the target kept its first velocity).
#pragma once

#include <memory>
#include <optional>
#include <utility>

#include "truebearing/simulation/scenario.hpp"
#include "truebearing/simulation/vessel.hpp"

namespace truebearing {

struct BearingsOnlyParameters {
  Distribution period_s = 4.0;  ///< samples at 0, period, ... duration
  double duration_s = 0.0;
  VesselParameters own_ship;
  VesselParameters target;
  Distribution range_m = 1.0;      ///< of the target at time 0
  Distribution bearing_deg = 0.0;  ///< of the target at time 0

  struct Sensor {
    double sigma_rad = 0.0;
    double dropout_share = 0.0;    ///< probability that a bearing is missing
    double outlier_share = 0.0;    ///< probability that a bearing's noise is
    double outlier_factor = 1.0;   ///< that many times as large
    bool masked_in_turns = false;  ///< is a bearing missing while own ship turns?
    bool reported = true;          ///< does a measurement carry its standard deviation?
  } sensor;

  /// The first measurement carries a guess of range, and of speed, that is as wrong as this; drawn again where it is
  /// less than the least.
  struct Guess {
    double range_sigma_m = 0.0;
    double least_range_m = 0.0;
    double speed_sigma_mps = 0.0;  ///< 0: no guess of the speed
    double least_speed_mps = 0.0;
  };
  std::optional<Guess> guess;

  double closest_m = 0.0;                     ///< of accepted draws
  std::optional<double> range_bound_percent;  ///< of accepted draws: the bound at the end, of the range then
};

/// A recording of bearings with plane truth and no step yet.
Recording empty_bearings();
/// Adds one to it: the bearing of a target in state [east, north, v_east, v_north] from own ship, with the sensor's
/// noise from `noise` and, to the first, the guess from `scenario`. The bearing of a target at an unknown place is
/// missing.
void add_bearing(const BearingsOnlyParameters& parameters, double time_s, const VesselPath::State& own_ship,
                 const Eigen::Vector4d& target, RandomStream& scenario, RandomStream& noise, Recording& recording);

class BearingsOnlyScenario final : public Scenario {
 public:
  explicit BearingsOnlyScenario(BearingsOnlyParameters parameters) : parameters_(std::move(parameters)) {}
  /// Throws InputError where a thousand draws were not accepted.
  Recording simulate(const RunKey& key) const override;
  const StateSpace& truth_space() const override { return plane_space(); }
  const BearingsOnlyParameters& parameters() const { return parameters_; }

 private:
  struct Draw;
  Draw draw(RandomStream& stream) const;
  bool accepts(const Draw& draw) const;

  BearingsOnlyParameters parameters_;
};

std::unique_ptr<Scenario> read_bearings_only_scenario(TableReader& table);

}  // namespace truebearing
