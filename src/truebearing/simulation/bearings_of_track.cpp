// SPDX-License-Identifier: Apache-2.0
#include "truebearing/simulation/bearings_of_track.hpp"

#include <cmath>
#include <fmt/format.h>
#include <utility>
#include <vector>

#include "truebearing/core/angle.hpp"
#include "truebearing/core/error.hpp"
#include "truebearing/recording/geographic_track.hpp"
#include "truebearing/recording/recording_csv.hpp"

namespace truebearing {

BearingsOfTrack::BearingsOfTrack(Recording track, double from_s, BearingsOnlyParameters parameters)
    : track_(std::move(track)), parameters_(std::move(parameters)) {
  if (!track_.truth_space || !begins_in_plane(*track_.truth_space) || track_.truth.size() != 1)
    throw InputError("track", "has no truth of one target in the plane",
                     "time_s, latitude_deg, longitude_deg, or a log with truth_east_m, truth_north_m");
  const auto is_begin = [&](std::size_t k) {
    return track_.measurements[k].time_s >= from_s && track_.truth.front().x[k].head<4>().allFinite();
  };
  while (begin_ < track_.measurements.size() && !is_begin(begin_)) ++begin_;
  if (begin_ == track_.measurements.size())
    throw InputError("track", fmt::format("has no known position from {:g} s on", from_s), "an earlier time");
}

Recording BearingsOfTrack::simulate(const RunKey& key) const {
  RandomStream scenario(key, StreamId::scenario);
  RandomStream noise(key, StreamId::measurement);
  const VesselPath own_ship = parameters_.own_ship.draw(Eigen::Vector2d::Zero(), scenario);
  const double range_m = parameters_.range_m.draw(scenario), bearing = radians(parameters_.bearing_deg.draw(scenario));
  std::optional<SourceTone> tone;
  if (parameters_.source) tone = parameters_.source->draw(scenario);
  const std::vector<BoundedVector>& truth = track_.truth.front().x;
  const Eigen::Vector2d shift_m =
      range_m * Eigen::Vector2d(std::sin(bearing), std::cos(bearing)) - truth[begin_].head<2>();

  Recording recording = empty_bearings(parameters_);
  for (std::size_t k = begin_; k < truth.size(); ++k) {
    const double time_s = track_.measurements[k].time_s - track_.measurements[begin_].time_s;
    if (time_s > parameters_.duration_s) break;
    BoundedVector target = truth[k].head<4>();
    target.head<2>() += shift_m;
    if (tone) {
      target.conservativeResize(5);
      target[4] = tone->at(time_s);
    }
    add_bearing(parameters_, time_s, own_ship.at(time_s), target, scenario, noise, recording);
  }
  return recording;
}

Recording read_target_track(const std::filesystem::path& path, const RecordingOptions& options) {
  CsvReader csv = open_table(path, options);
  if (!is_geographic_track(csv)) {
    if (!options.target.empty() && !find_target_column(csv, options))
      throw InputError(path.string(), "holds one track", "no --track-id");
    return read_recording(std::move(csv), options);
  }
  GeographicTracks tracks = read_geographic_tracks(std::move(csv), {}, options);
  if (tracks.recordings.size() > 1)
    throw InputError(path.string(), fmt::format("has {} tracks", tracks.recordings.size()),
                     fmt::format("--track-id with the name of one: {}", fmt::join(tracks.names, ", ")));
  return std::move(tracks.recordings.front());
}

}  // namespace truebearing
