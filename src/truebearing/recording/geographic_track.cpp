// SPDX-License-Identifier: Apache-2.0
#include "truebearing/recording/geographic_track.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <GeographicLib/LocalCartesian.hpp>
#include <GeographicLib/Math.hpp>
#include <limits>
#include <optional>
#include <span>
#include <system_error>
#include <unordered_map>
#include <utility>

#include "truebearing/core/angle.hpp"
#include "truebearing/core/constants.hpp"
#include "truebearing/core/error.hpp"
#include "truebearing/core/printable.hpp"
#include "truebearing/recording/geographic_fixes.hpp"
#include "truebearing/recording/time_column.hpp"
#include "truebearing/recording/velocity_truth.hpp"

namespace truebearing {
namespace {

struct FixColumns {
  TimeColumn time;
  LogColumn latitude, longitude;
  std::optional<std::size_t> target;
  std::optional<LogColumn> speed, course;  // both or neither
  std::optional<LogColumn> altitude;
};

LogColumn required_angle(const CsvReader& csv, const std::string& stem) {
  const auto column = find_column(csv, stem, Dimension::angle);
  return column ? *column : LogColumn{csv.required_column(stem + "_deg"), ColumnRole::position, stem + "_deg"};
}

FixColumns find_columns(const CsvReader& csv, const RecordingOptions& options) {
  FixColumns columns{TimeColumn(csv),
                     required_angle(csv, "latitude"),
                     required_angle(csv, "longitude"),
                     find_target_column(csv, options),
                     std::nullopt,
                     std::nullopt,
                     find_column(csv, "altitude", Dimension::length)};
  for (const auto& [speed, course] :
       {std::pair("groundspeed", "track"), std::pair("sog", "cog"), std::pair("speed", "course")}) {
    const auto speed_column = find_column(csv, speed, Dimension::speed);
    const auto course_column = find_column(csv, course, Dimension::angle);
    if (!speed_column || !course_column) continue;
    columns.speed = speed_column;
    columns.course = course_column;
  }
  return columns;
}

/// A range of angles in degrees, and what a transponder sends that does not know its own.
struct AngleRange {
  double low, high, none;
};

// In degrees, whatever the unit.
double read_angle(const CsvReader& csv, const LogColumn& column, const AngleRange& range, bool& not_available) {
  const double number = csv.number(column.index);
  const double angle_deg = column.quantity.ends_with("_deg") ? number : degrees(number * column.factor);
  if (angle_deg == range.none) {
    not_available = true;
    return kNaN;
  }
  if (angle_deg < range.low || angle_deg > range.high)
    throw csv.error(column.index, "is " + as_shown(csv.word(column.index)),
                    fmt::format("degrees in [{}, {}]", range.low, range.high));
  return angle_deg;
}

Eigen::Vector2d read_velocity(const CsvReader& csv, const FixColumns& columns, std::size_t& not_available) {
  // ITU-R M.1371: 102.3 knots and course 360 are not available.
  constexpr double kNoSpeed_mps = 102.3 * 1852.0 / 3600.0, kNoCourse_rad = radians(360.0), kRounding = 1e-9;
  const double speed_mps = csv.number(columns.speed->index) * columns.speed->factor;
  const double course_rad = csv.number(columns.course->index) * columns.course->factor;
  if (std::abs(speed_mps - kNoSpeed_mps) > kRounding || std::abs(course_rad - kNoCourse_rad) > kRounding)
    return speed_mps * Eigen::Vector2d(std::sin(course_rad), std::cos(course_rad));
  ++not_available;
  return {kNaN, kNaN};
}

GeographicFix read_fix(const CsvReader& csv, FixColumns& columns, std::size_t& not_available) {
  constexpr AngleRange kLatitude{-90.0, 90.0, 91.0}, kLongitude{-180.0, 360.0, 181.0};  // of ITU-R M.1371
  bool has_no_position = false;
  GeographicFix fix{columns.time.read(csv), read_angle(csv, columns.latitude, kLatitude, has_no_position),
                    read_angle(csv, columns.longitude, kLongitude, has_no_position)};
  not_available += has_no_position;
  if (columns.speed) fix.velocity_mps = read_velocity(csv, columns, not_available);
  if (columns.altitude) fix.altitude_m = csv.number(columns.altitude->index) * columns.altitude->factor;
  if (std::isnan(fix.latitude_deg) || std::isnan(fix.longitude_deg)) fix.latitude_deg = fix.longitude_deg = kNaN;
  return fix;
}

std::string names_of(const std::vector<GeographicTarget>& targets) {
  constexpr std::size_t kMostNames = 12;
  std::string list;
  for (std::size_t i = 0; i < std::min(targets.size(), kMostNames); ++i)
    list.append(i == 0 ? "" : ", ").append(targets[i].name);
  return targets.size() > kMostNames ? list + ", ..." : list;
}

// Targets in the order of their first rows, and where each is found by its name.
class Targets {
 public:
  GeographicTarget& of(const std::string& name) {
    const auto [place, is_new] = places_.try_emplace(name, targets_.size());
    if (is_new) targets_.push_back(GeographicTarget{name, {}});
    return targets_[place->second];
  }
  std::vector<GeographicTarget> all() && { return std::move(targets_); }

 private:
  std::vector<GeographicTarget> targets_;
  std::unordered_map<std::string, std::size_t> places_;
};

std::string read_name(const CsvReader& csv, const FixColumns& columns) {
  if (!columns.target) return {};
  std::string name = read_target_name(csv, *columns.target);
  if (name.empty()) throw csv.error(*columns.target, "is empty", "an integer or a name that tells targets apart");
  return name;
}

// Of a late fix and those after it, which are read for that where they are a file's.
double greatest_lateness(CsvReader& csv, FixColumns& columns, const RecordingOptions& options, double time_s,
                         const GeographicTarget& target, Targets& targets) {
  double late_s = target.latest_s - time_s;
  std::error_code unknown;
  if (!std::filesystem::is_regular_file(csv.name(), unknown)) return late_s;
  try {
    while (csv.next()) {
      const std::string name = read_name(csv, columns);
      if (!options.target.empty() && name != options.target) continue;
      double& latest_s = targets.of(name).latest_s;
      const double next_s = columns.time.read(csv);
      latest_s = std::max(latest_s, next_s);
      late_s = std::max(late_s, latest_s - next_s);
    }
  } catch (const InputError&) {  // which is said when it is its turn
  }
  return late_s;
}

std::vector<GeographicTarget> read_targets(CsvReader& csv, const RecordingOptions& options, GeographicTracks& tracks) {
  FixColumns columns = find_columns(csv, options);
  if (!options.target.empty() && !columns.target)
    throw InputError(csv.name(), "has no column that tells targets apart",
                     "vessel, flight, track, mmsi, icao24, callsign");
  Targets targets;
  while (csv.next()) {
    const std::string name = read_name(csv, columns);
    GeographicTarget& target = targets.of(name);
    if (!options.target.empty() && name != options.target) continue;
    const GeographicFix fix = read_fix(csv, columns, tracks.not_available);
    if (fix.time_s < target.latest_s - options.sort_window_s) {
      const InputError late =
          csv.error(columns.time.index(), fmt::format("is {}, earlier than {} before it", fix.time_s, target.latest_s));
      throw InputError(late.where(), late.found(),
                       fmt::format("times that do not decrease, or --sort-window {:.9g} or more",
                                   greatest_lateness(csv, columns, options, fix.time_s, target, targets)));
    }
    tracks.late += fix.time_s < target.latest_s;
    if (!fix.is_missing())
      tracks.widest_deg = std::max({tracks.widest_deg, std::abs(fix.latitude_deg), std::abs(fix.longitude_deg)});
    target.latest_s = std::max(target.latest_s, fix.time_s);
    target.fixes.push_back(fix);
  }
  std::vector<GeographicTarget> all = std::move(targets).all();
  const auto is_wanted = [&](const GeographicTarget& target) { return target.name == options.target; };
  if (options.target.empty()) return all;
  if (std::none_of(all.begin(), all.end(), is_wanted))
    throw InputError(csv.name(), "has no track " + as_shown(options.target), "one of " + names_of(all));
  std::erase_if(all, [&](const GeographicTarget& target) { return !is_wanted(target); });
  return all;
}

// The frame whose origin is in the middle of the target's area. Longitudes are taken relative to one of them, so that
// 180 degrees is a longitude like any other.
GeographicLib::LocalCartesian local_frame(const GeographicTarget& target) {
  const auto first = std::find_if(target.fixes.begin(), target.fixes.end(),
                                  [](const GeographicFix& fix) { return !fix.is_missing(); });
  double south = first->latitude_deg, north = first->latitude_deg, west = 0.0, east = 0.0;
  for (const GeographicFix& fix : target.fixes) {
    if (fix.is_missing()) continue;
    const double turn_deg = GeographicLib::Math::AngDiff(first->longitude_deg, fix.longitude_deg);
    south = std::min(south, fix.latitude_deg);
    north = std::max(north, fix.latitude_deg);
    west = std::min(west, turn_deg);
    east = std::max(east, turn_deg);
  }
  return {0.5 * (south + north), first->longitude_deg + 0.5 * (west + east)};
}

// Indices of the fixes at which a stretch of the track begins: the first, and the first after each gap.
std::vector<std::size_t> stretches(const GeographicTarget& target, double max_gap_periods) {
  std::vector<std::size_t> usable;
  for (std::size_t k = 0; k < target.fixes.size(); ++k)
    if (!target.fixes[k].is_missing()) usable.push_back(k);
  std::vector<double> periods_s;
  for (std::size_t i = 1; i < usable.size(); ++i)
    periods_s.push_back(target.fixes[usable[i]].time_s - target.fixes[usable[i - 1]].time_s);
  std::vector<double> sorted_s = periods_s;
  const auto median = sorted_s.begin() + static_cast<std::ptrdiff_t>(sorted_s.size() / 2);
  std::nth_element(sorted_s.begin(), median, sorted_s.end());
  std::vector<std::size_t> starts{0};
  for (std::size_t i = 0; i < periods_s.size(); ++i)
    if (periods_s[i] > max_gap_periods * *median) starts.push_back(usable[i + 1]);
  return starts;
}

// Velocities stretch by stretch, then NaN where nothing is to be scored.
// Returns the highest speed, whether it is scored or not.
double complete_truth(const GeographicTarget& target, const GeographicTrackOptions& options,
                      std::vector<BoundedVector>& x) {
  const StateSpace& space = options.in_space ? space_space() : plane_space();
  const int d = space.size() / 2;
  std::vector<bool> given(space.components.size(), false);
  std::fill_n(given.begin(), options.recorded_velocity ? d + 2 : d, true);
  std::vector<double> time_s;
  for (const GeographicFix& fix : target.fixes) time_s.push_back(fix.time_s);
  std::vector<std::size_t> starts = stretches(target, options.max_gap_periods);
  starts.push_back(x.size());
  for (std::size_t i = 0; i + 1 < starts.size(); ++i) {
    const std::size_t count = starts[i + 1] - starts[i];
    if (options.recorded_velocity)
      for (std::size_t k = starts[i]; k < starts[i + 1]; ++k) x[k].segment<2>(d) = target.fixes[k].velocity_mps;
    complete_velocities(space, given, std::span(time_s).subspan(starts[i], count),
                        std::span(x).subspan(starts[i], count));
  }
  for (std::size_t i = 1; i + 1 < starts.size(); ++i) x[starts[i]].setConstant(kNaN);
  double fastest_mps = 0.0;
  for (BoundedVector& state : x) {
    const double speed_mps = state.segment<2>(d).norm();  // along the ground
    if (speed_mps > fastest_mps) fastest_mps = speed_mps;
    if (speed_mps < options.min_speed_mps) state.setConstant(kNaN);
  }
  return fastest_mps;
}

Recording make_recording(const GeographicTarget& target, const GeographicTrackOptions& options, double& fastest_mps) {
  const GeographicLib::LocalCartesian frame = local_frame(target);
  Recording recording;
  recording.truth_space = options.in_space ? &space_space() : &plane_space();
  const int d = recording.truth_space->size() / 2;
  recording.measured = Measured::position(d).components;
  recording.truth.resize(1);
  for (const GeographicFix& fix : target.fixes) {
    Measurement measurement;
    measurement.time_s = fix.time_s;
    measurement.z = BoundedVector::Constant(d, kNaN);
    const double altitude_m = options.in_space ? fix.altitude_m : 0.0;
    Eigen::Vector3d place_m;
    if (!fix.is_missing() && !std::isnan(altitude_m)) {
      frame.Forward(fix.latitude_deg, fix.longitude_deg, altitude_m, place_m[0], place_m[1], place_m[2]);
      measurement.z = place_m.head(d);
    }
    BoundedVector x = BoundedVector::Constant(2 * d, kNaN);
    x.head(d) = measurement.z;
    recording.counts.missing += measurement.is_missing();
    recording.measurements.push_back(std::move(measurement));
    recording.truth[0].x.push_back(std::move(x));
  }
  recording.counts.repeated = target.repeated;
  recording.counts.glitches = target.glitches;
  if (options.recorded_velocity) recording.counts.wrong_velocities = target.wrong_velocities;
  fastest_mps = std::max(fastest_mps, complete_truth(target, options, recording.truth[0].x));
  return recording;
}

}  // namespace

bool is_geographic_track(const CsvReader& csv) {
  return find_column(csv, "latitude", Dimension::angle).has_value();
}

bool is_geographic_track(const std::filesystem::path& path) {
  std::error_code unknown;
  if (!std::filesystem::is_regular_file(path, unknown)) return false;  // a pipe can be read only once
  return is_geographic_track(open_table(path));
}

GeographicTracks read_geographic_tracks(CsvReader csv, const GeographicTrackOptions& options,
                                        const RecordingOptions& recording) {
  GeographicTracks tracks;
  GeographicTrackOptions believed = options;
  const FixColumns columns = find_columns(csv, recording);
  believed.recorded_velocity &= columns.speed.has_value();
  tracks.has_altitude = columns.altitude.has_value();
  if (options.in_space && !columns.altitude)
    throw InputError(csv.name(), "has no altitude, which a study in space needs", "a column altitude_m");
  std::size_t rows = 0, glitches = 0;
  for (GeographicTarget& target : read_targets(csv, recording, tracks)) {
    put_in_order(target);
    tracks.null_island += remove_null_island(target);
    if (options.in_space) remove_without_altitude(target);
    if (std::isfinite(options.max_speed_mps)) remove_glitches(target, options.max_speed_mps);
    remove_wrong_velocities(target, options.max_speed_mps);
    rows += target.fixes.size();
    glitches += static_cast<std::size_t>(target.glitches);
    const auto usable = std::count_if(target.fixes.begin(), target.fixes.end(),
                                      [](const GeographicFix& fix) { return !fix.is_missing(); });
    if (usable < kFewestRows) {
      ++tracks.left_out;
      continue;
    }
    tracks.recordings.push_back(make_recording(target, believed, tracks.fastest_mps));
    if (columns.target) tracks.names.push_back(target.name);
  }
  if (tracks.recordings.empty())
    throw InputError(csv.name(),
                     fmt::format("has no track to follow: {} rows of {} targets, {} of them glitches", rows,
                                 tracks.left_out, glitches),
                     fmt::format("at least {} usable rows of one", kFewestRows));
  return tracks;
}

GeographicTracks read_geographic_tracks(const std::filesystem::path& path, const GeographicTrackOptions& options,
                                        const RecordingOptions& recording) {
  return read_geographic_tracks(open_table(path, recording), options, recording);
}

GeographicTracks read_geographic_tracks(std::istream& stream, const std::string& name,
                                        const GeographicTrackOptions& options, const RecordingOptions& recording) {
  return read_geographic_tracks(with_names(CsvReader(stream, name), recording), options, recording);
}

std::vector<LogColumn> geographic_columns(const CsvReader& csv, const RecordingOptions& options) {
  const FixColumns found = find_columns(csv, options);
  std::vector<LogColumn> columns(csv.header().size());
  for (std::size_t index = 0; index < columns.size(); ++index) columns[index].index = index;
  const auto take = [&](const LogColumn& column, ColumnRole role) {
    columns[column.index] = column;
    columns[column.index].role = role;
  };
  take({found.time.index(), ColumnRole::time, "time_s"}, ColumnRole::time);
  take(found.latitude, ColumnRole::position);
  take(found.longitude, ColumnRole::position);
  if (found.target) take({*found.target, ColumnRole::target, "target"}, ColumnRole::target);
  if (found.speed) take(*found.speed, ColumnRole::velocity);
  if (found.course) take(*found.course, ColumnRole::velocity);
  if (found.altitude) take(*found.altitude, ColumnRole::altitude);
  return columns;
}

}  // namespace truebearing
