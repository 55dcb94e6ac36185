// SPDX-License-Identifier: Apache-2.0
// Recorded positions on the globe as recordings in the plane: CSV with a time (time_column.hpp), `latitude_deg` and
// `longitude_deg` (WGS-84), and optionally `vessel`, `flight`, `track`, `mmsi`, `icao24` or `callsign`, a text that tells
// targets apart whose rows are interleaved, and in space `altitude_m` above the ellipsoid. Other columns are passed
// over. What a transponder says of its own course and speed is no truth as a rule; it is taken for one only on request,
// for a recording whose positions are too rough to differentiate.
//
// Each target becomes a recording of east_m and north_m, in space with up_m, in a local East-North-Up frame whose origin
// lies in the middle of its area, on the ellipsoid. The truth is the recorded position itself and its velocity_truth(), which does not reach across a gap.
#pragma once

#include <filesystem>
#include <istream>
#include <limits>
#include <string>
#include <vector>

#include "truebearing/io/csv.hpp"
#include "truebearing/recording/log_columns.hpp"
#include "truebearing/recording/recording.hpp"
#include "truebearing/recording/recording_options.hpp"

namespace truebearing {

/// What of a recorded track is believed, and what is scored.
struct GeographicTrackOptions {
  /// Positions that would take a higher speed to be reached from the others are glitches: measurement and truth are
  /// missing. Velocities beyond it are missing too.
  double max_speed_mps = std::numeric_limits<double>::infinity();
  /// Slower than this, the truth is NaN: measured, but not scored.
  double min_speed_mps = 0.0;
  /// True velocity from the columns groundspeed_kn and track_deg, sog_kn and cog_deg, or speed_kn and course_deg, where
  /// the file has them (in any units), in place of the slope of the positions; missing where a row has none.
  bool recorded_velocity = false;
  /// The first step after a gap of more than that many median periods has no truth either.
  double max_gap_periods = std::numeric_limits<double>::infinity();
  /// Heights count: measured are three coordinates, and a row without an altitude is missing. In the plane they do not,
  /// and every position is taken as one on the ellipsoid.
  bool in_space = false;
};

/// Fewer usable rows than this are no track.
inline constexpr int kFewestRows = 20;

struct GeographicTracks {
  /// One per target, in the order of their first rows.
  std::vector<Recording> recordings;
  std::vector<std::string> names;  ///< of these targets as the file has them; empty where it does not tell them apart
  bool has_altitude = false;       ///< has the file such a column?
  int left_out = 0;                ///< targets with fewer than kFewestRows usable rows
  std::size_t late = 0;            ///< rows put in order
  std::size_t not_available = 0;   ///< positions and velocities by which AIS says that there is none
  std::size_t null_island =
      0;                     ///< positions at 0, 0 of a target that is nowhere near, as receivers write without a fix
  double widest_deg = 0.0;   ///< the greatest latitude or longitude, without its sign
  double fastest_mps = 0.0;  ///< of all true velocities, before min_speed_mps
};

/// Does the header name latitude_deg or latitude_rad?
bool is_geographic_track(const CsvReader& csv);
/// The same of a regular file. Throws InputError where it cannot be read.
bool is_geographic_track(const std::filesystem::path& path);

/// Empty cells make a row missing, and so does what AIS sends for "not available" (latitude 91, longitude 181); a row
/// with the time and place of the target's last is dropped; both are counted.
/// Throws InputError that names the row: a time that is missing or decreases within a target by more than the sort
/// window, a latitude outside [-90, 90], a longitude outside [-180, 360]; and where no target has kFewestRows usable
/// rows.
GeographicTracks read_geographic_tracks(const std::filesystem::path& path, const GeographicTrackOptions& options = {},
                                        const RecordingOptions& recording = {});
/// The same for a stream; `name` stands for the file in messages.
GeographicTracks read_geographic_tracks(std::istream& stream, const std::string& name,
                                        const GeographicTrackOptions& options = {},
                                        const RecordingOptions& recording = {});
/// The same for a file that is open and has the names that the options give it: with_names().
GeographicTracks read_geographic_tracks(CsvReader csv, const GeographicTrackOptions& options,
                                        const RecordingOptions& recording);

/// What each column of such a file is taken for.
std::vector<LogColumn> geographic_columns(const CsvReader& csv, const RecordingOptions& options);

}  // namespace truebearing
