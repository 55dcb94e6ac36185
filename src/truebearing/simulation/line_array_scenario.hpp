// SPDX-License-Identifier: Apache-2.0
// Several targets heard by a line array (kind = "line_array"): complex Gaussian signals in noise, a block of snapshots
// every period. Targets stand still inside an interval, at the angle that its end has, or move through it (`moving`).
//   period_s, first_interval, intervals, moving
//   [array]    sensors, spacing_wavelengths (or spacing_m, frequency_hz, sound_mps), snapshots, noise_power,
//              dead_sensors = [...] counted from 0, lost_share: probability that a snapshot comes as NaN
//   [signals]  snr_db: of each run; snr_spread_db: added, of each target; correlation: between any two signals, [0, 1)
//   [[targets]]  an angle's path (angle_path.hpp); appears_s, vanishes_s
//   [random]   or this in place of them: targets, start_deg, least_separation_sine, rate_degps, changes,
//              rate_change_degps, change_at_s, change_width_s, largest_deg; appears_s, stays_s.
//              A rate, with that many changes, each dr/2 (1 + tanh((t - t_c)/w)); the angle is the start plus the
//              summed rate. Starts are drawn again while two of them are closer than least_separation_sine in their
//              sines, and all of it while an angle passes largest_deg. True tracks are numbered in the order of their
//              angles in the first interval.
//   [phases]   crossing_deg, manoeuvre_degps2: tells steps apart for the report: "crossing" while another target is
//              closer, else "manoeuvre" while the rate changes faster, else "quiet"
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "truebearing/simulation/angle_path.hpp"
#include "truebearing/simulation/distribution.hpp"
#include "truebearing/simulation/scenario.hpp"

namespace truebearing {

struct LineArrayParameters {
  double period_s = 1.0;
  int first_interval = -1;  ///< ends at first_interval * period_s
  int intervals = 1;
  bool moving = false;

  int sensors = 15;
  double spacing_wavelengths = 0.5;
  int snapshots = 30;
  double noise_power = 1.0;
  std::vector<int> dead_sensors;
  double lost_share = 0.0;

  Distribution snr_db = 0.0;
  Distribution snr_spread_db = 0.0;
  double correlation = 0.0;

  struct Target {
    AnglePath path;
    double appears_s, vanishes_s;
  };
  std::vector<Target> targets;

  struct Random {
    int targets = 1;
    Distribution start_deg = 0.0;
    double least_separation_sine = 0.0;
    Distribution rate_degps = 0.0;
    Distribution changes = 0.0;
    Distribution rate_change_degps = 0.0;
    Distribution change_at_s = 0.0;
    Distribution change_width_s = 1.0;
    double largest_deg = 90.0;
    std::optional<Distribution> appears_s, stays_s;
  };
  std::optional<Random> random;

  struct Phases {
    double crossing_rad, manoeuvre_radps2;
  };
  std::optional<Phases> phases;
};

class LineArrayScenario final : public Scenario {
 public:
  explicit LineArrayScenario(LineArrayParameters parameters) : parameters_(std::move(parameters)) {}
  /// Throws InputError where no draw of random targets keeps to the limits.
  Recording simulate(const RunKey& key) const override;
  const StateSpace& truth_space() const override;
  std::optional<Measured> measured() const override { return Measured::snapshots(parameters_.sensors); }
  std::string note() const override;
  const LineArrayParameters& parameters() const { return parameters_; }

 private:
  LineArrayParameters parameters_;
};

std::unique_ptr<Scenario> read_line_array_scenario(TableReader& table);

}  // namespace truebearing
