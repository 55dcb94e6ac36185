// SPDX-License-Identifier: Apache-2.0
// Recorded tracks as a scenario: the truth is the recording's own, and every run measures it afresh with Gaussian
// noise. What the recording did not measure stays missing. Of several tracks, run k measures number k mod count. The
// snapshots of a line array cannot be measured afresh, nor can a log that does not say how good its measurements are:
// every run replays them.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "truebearing/simulation/scenario.hpp"

namespace truebearing {

/// The sensor that recorded positions are measured with. It stands at the origin: `site_m` of the recording's frame
/// becomes the origin of the scenario's.
struct RecordedSensor {
  enum class Output { position, range_bearing };

  Output output = Output::position;
  double sigma_m = 1.0;            ///< of the position per axis, or of the range
  double bearing_sigma_rad = 0.0;  ///< of range_bearing
  Eigen::Vector2d site_m = Eigen::Vector2d::Zero();
  bool in_space = false;  ///< are heights measured too: up, or by range, bearing and elevation?
  double elevation_sigma_rad = 0.0;
  double site_up_m = 0.0;
  bool reported = false;  ///< does a measurement carry its standard deviations?

  Measured measured() const;
};

class RecordedScenario final : public Scenario {
 public:
  /// A log, measured with its own sigma; or a snapshot log, of any number of targets. `sigma`, in the unit of the
  /// measured columns, stands in where the recording carries none. Throws InputError where the recording has no truth,
  /// a measured column does not follow from it, or a sigma is missing.
  explicit RecordedScenario(Recording recorded, std::optional<double> sigma = std::nullopt);

  /// Recorded positions (measured east_m, north_m, truth in plane_space(); or with up_m, in space_space()), taken as exact and measured by the sensor,
  /// also at steps that have no truth to be scored against. Throws InputError for other recordings or none.
  RecordedScenario(std::vector<Recording> positions, const RecordedSensor& sensor);

  /// A log with truth as it is, in every run. Throws InputError where it has none.
  static RecordedScenario replayed(Recording recorded);

  Recording simulate(const RunKey& key) const override;
  const StateSpace& truth_space() const override { return *tracks_.front().exact.truth_space; }
  std::optional<Measured> measured() const override { return Measured::of(tracks_.front().exact.measured); }
  std::optional<std::size_t> different_runs(Role) const override;

 private:
  RecordedScenario() = default;

  struct Track {
    Recording exact;                   // z without noise
    std::vector<BoundedVector> sigma;  // of each measurement; none where it is replayed
  };
  std::vector<Track> tracks_;
  Eigen::Index bearing_ = -1;  // the component of z that is an angle
};

/// Why a log with truth of one target cannot be measured afresh, as in "carries no sigma"; empty where it can.
std::string reason_to_replay(const Recording& recorded);

}  // namespace truebearing
