// SPDX-License-Identifier: Apache-2.0
// A scenario of bearings whose target sails a recorded track instead of a simulated path: the truth is the track's own,
// at its own times, moved so that it begins at the scenario's range and bearing from own ship. Own ship, sensor, source
// and guess are the scenario's; its period, its target's course and speed, its phases and what it accepts are not
// asked.
#pragma once

#include <filesystem>
#include <optional>

#include "truebearing/recording/recording_options.hpp"
#include "truebearing/simulation/bearings_only_scenario.hpp"

namespace truebearing {

class BearingsOfTrack final : public Scenario {
 public:
  /// From the first known state at `from_s` of the track's time on, which becomes time 0, for the scenario's duration.
  /// Throws InputError where the track has no truth of one target in the plane, or none then.
  BearingsOfTrack(Recording track, double from_s, BearingsOnlyParameters parameters);

  Recording simulate(const RunKey& key) const override;
  const StateSpace& truth_space() const override { return parameters_.truth_space(); }
  std::optional<Measured> measured() const override { return parameters_.measured(); }
  bool reports_sigma() const override { return parameters_.sensor.reported; }

 private:
  Recording track_;
  std::size_t begin_ = 0;
  BearingsOnlyParameters parameters_;
};

/// A track from positions on the globe, of options.target where there are several (recording/geographic_track.hpp), or
/// from a log with its truth. Throws InputError.
Recording read_target_track(const std::filesystem::path& path, const RecordingOptions& options = {});

}  // namespace truebearing
