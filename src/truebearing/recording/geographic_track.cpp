#include "truebearing/recording/geographic_track.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <GeographicLib/Geocentric.hpp>
#include <GeographicLib/LocalCartesian.hpp>
#include <GeographicLib/Math.hpp>
#include <span>
#include <utility>

#include "truebearing/core/angle.hpp"
#include "truebearing/core/constants.hpp"
#include "truebearing/core/error.hpp"
#include "truebearing/io/csv.hpp"
#include "truebearing/recording/velocity_truth.hpp"

namespace truebearing {
namespace {

constexpr std::array<const char*, 3> kTargetColumns{"vessel", "flight", "track"};

struct Fix {
  double time_s;
  double latitude_deg;  // NaN, both, where there is none
  double longitude_deg;
  Eigen::Vector2d velocity_mps{kNaN, kNaN};  // East, North, as the target itself said

  bool is_missing() const { return std::isnan(latitude_deg); }
  bool operator==(const Fix& other) const {
    return time_s == other.time_s && ((is_missing() && other.is_missing()) ||
                                      (latitude_deg == other.latitude_deg && longitude_deg == other.longitude_deg));
  }
};

struct Target {
  double number;
  std::vector<Fix> fixes;
  int repeated = 0;
  int glitches = 0;
  int wrong_velocities = 0;
};

struct FixColumns {
  std::size_t time, latitude, longitude;
  int target = -1;
  int speed = -1, course = -1;
};

FixColumns find_columns(const CsvReader& csv) {
  FixColumns columns{csv.required_column("time_s"), csv.required_column("latitude_deg"),
                     csv.required_column("longitude_deg")};
  for (const char* name : kTargetColumns) {
    const int column = csv.column(name);
    if (column < 0) continue;
    if (columns.target >= 0)
      throw InputError(
          csv.name(),
          fmt::format("has the columns {} and {}", csv.header()[static_cast<std::size_t>(columns.target)], name),
          "one column that separates targets");
    columns.target = column;
  }
  for (const auto& [speed, course] : {std::pair("groundspeed_kn", "track_deg"), std::pair("speed_kn", "course_deg")})
    if (csv.column(speed) >= 0 && csv.column(course) >= 0) {
      columns.speed = csv.column(speed);
      columns.course = csv.column(course);
    }
  return columns;
}

// `none`: what a transponder sends that does not know it.
double read_angle(const CsvReader& csv, std::size_t column, double low, double high, double none) {
  const double angle_deg = csv.number(column);
  if (angle_deg == none) return kNaN;
  if (angle_deg < low || angle_deg > high)
    throw csv.error(column, fmt::format("is {}", angle_deg), fmt::format("degrees in [{}, {}]", low, high));
  return angle_deg;
}

Fix read_fix(const CsvReader& csv, const FixColumns& columns) {
  // ITU-R M.1371: latitude 91, longitude 181, 102.3 knots, course 360 are not available.
  constexpr double kNoLatitude_deg = 91.0, kNoLongitude_deg = 181.0, kNoSpeed_kn = 102.3, kNoCourse_deg = 360.0;
  Fix fix{csv.number(columns.time), read_angle(csv, columns.latitude, -90.0, 90.0, kNoLatitude_deg),
          read_angle(csv, columns.longitude, -180.0, 360.0, kNoLongitude_deg)};
  if (std::isnan(fix.time_s)) throw csv.error(columns.time, "is missing or infinite", "a finite time");
  if (columns.speed >= 0) {
    constexpr double kKnot_mps = 1852.0 / 3600.0;
    const double course_deg = csv.number(static_cast<std::size_t>(columns.course));
    const double speed_kn = csv.number(static_cast<std::size_t>(columns.speed)), course_rad = radians(course_deg);
    if (speed_kn != kNoSpeed_kn || course_deg != kNoCourse_deg)
      fix.velocity_mps = kKnot_mps * speed_kn * Eigen::Vector2d(std::sin(course_rad), std::cos(course_rad));
  }
  if (std::isnan(fix.latitude_deg) || std::isnan(fix.longitude_deg)) fix.latitude_deg = fix.longitude_deg = kNaN;
  return fix;
}

double read_target(const CsvReader& csv, const FixColumns& columns) {
  if (columns.target < 0) return 0.0;
  const auto column = static_cast<std::size_t>(columns.target);
  const double number = csv.number(column);
  if (std::isnan(number) || number != std::floor(number))
    throw csv.error(column, fmt::format("is \"{}\"", csv.text(column)), "an integer");
  return number;
}

std::vector<Target> read_targets(CsvReader& csv) {
  const FixColumns columns = find_columns(csv);
  std::vector<Target> targets;
  while (csv.next()) {
    const double number = read_target(csv, columns);
    const Fix fix = read_fix(csv, columns);
    auto target = std::find_if(targets.begin(), targets.end(), [&](const Target& t) { return t.number == number; });
    if (target == targets.end()) target = targets.insert(targets.end(), Target{number, {}});
    if (!target->fixes.empty()) {
      const Fix& last = target->fixes.back();
      if (fix.time_s < last.time_s)
        throw csv.error(columns.time, fmt::format("is {}, earlier than {} before it", fix.time_s, last.time_s),
                        "times that do not decrease");
      if (fix == last) {
        ++target->repeated;
        continue;
      }
    }
    target->fixes.push_back(fix);
  }
  return targets;
}

Eigen::Vector3d geocentric(const Fix& fix) {
  Eigen::Vector3d position_m;
  GeographicLib::Geocentric::WGS84().Forward(fix.latitude_deg, fix.longitude_deg, 0.0, position_m.x(), position_m.y(),
                                             position_m.z());
  return position_m;
}

// Fixes of one target that it could have reached one from another.
struct Chain {
  Eigen::Vector3d position_m;  // of the last one
  double since_s;              // when it was first there: receivers repeat a position until they have another
  int length = 0;
};

// Takes out the fixes that no target could have reached in time: all but those of the longest chain, so that a wrong
// position, be it the first, does not lock out the good ones. A fix goes on with the longest chain that it could.
void remove_glitches(Target& target, double max_speed_mps) {
  constexpr std::size_t kMostChains = 8;  // the shortest gives way
  const auto is_shorter = [](const auto& a, const auto& b) { return a.second.length < b.second.length; };
  std::vector<std::pair<int, Chain>> chains;  // with their numbers
  std::vector<int> chain_of(target.fixes.size(), -1);
  int begun = 0;
  for (std::size_t k = 0; k < target.fixes.size(); ++k) {
    const Fix& fix = target.fixes[k];
    if (fix.is_missing()) continue;
    const Eigen::Vector3d position_m = geocentric(fix);
    std::pair<int, Chain>* longest = nullptr;
    for (auto& chain : chains) {
      const double reach_m = max_speed_mps * (fix.time_s - chain.second.since_s);
      const bool is_reached = (position_m - chain.second.position_m).norm() <= reach_m;
      if (is_reached && (!longest || is_shorter(*longest, chain))) longest = &chain;
    }
    if (!longest) {
      if (chains.size() == kMostChains) chains.erase(std::min_element(chains.begin(), chains.end(), is_shorter));
      longest = &chains.emplace_back(begun++, Chain{position_m, fix.time_s});
    }
    Chain& chain = longest->second;
    if (position_m != chain.position_m) chain.since_s = fix.time_s;
    chain.position_m = position_m;
    ++chain.length;
    chain_of[k] = longest->first;
  }
  if (chains.empty()) return;
  const int kept = std::max_element(chains.begin(), chains.end(), is_shorter)->first;
  for (std::size_t k = 0; k < target.fixes.size(); ++k) {
    Fix& fix = target.fixes[k];
    if (fix.is_missing() || chain_of[k] == kept) continue;
    fix.latitude_deg = fix.longitude_deg = kNaN;
    ++target.glitches;
  }
}

// Takes out the velocities that no target has.
void remove_wrong_velocities(Target& target, double max_speed_mps) {
  for (Fix& fix : target.fixes) {
    if (!(fix.velocity_mps.norm() > max_speed_mps)) continue;
    fix.velocity_mps.setConstant(kNaN);
    ++target.wrong_velocities;
  }
}

// The frame whose origin is in the middle of the target's area. Longitudes are taken relative to one of them, so that
// 180 degrees is a longitude like any other.
GeographicLib::LocalCartesian local_frame(const Target& target) {
  const auto first =
      std::find_if(target.fixes.begin(), target.fixes.end(), [](const Fix& fix) { return !fix.is_missing(); });
  double south = first->latitude_deg, north = first->latitude_deg, west = 0.0, east = 0.0;
  for (const Fix& fix : target.fixes) {
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
std::vector<std::size_t> stretches(const Target& target, double max_gap_periods) {
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
void complete_truth(const Target& target, const GeographicTrackOptions& options, std::vector<BoundedVector>& x) {
  std::vector<double> time_s;
  for (const Fix& fix : target.fixes) time_s.push_back(fix.time_s);
  std::vector<std::size_t> starts = stretches(target, options.max_gap_periods);
  starts.push_back(x.size());
  for (std::size_t i = 0; i + 1 < starts.size(); ++i) {
    const std::size_t count = starts[i + 1] - starts[i];
    if (options.recorded_velocity)
      for (std::size_t k = starts[i]; k < starts[i + 1]; ++k) x[k].tail<2>() = target.fixes[k].velocity_mps;
    else
      complete_velocities(plane_space(), {true, true, false, false}, std::span(time_s).subspan(starts[i], count),
                          std::span(x).subspan(starts[i], count));
  }
  for (std::size_t i = 1; i + 1 < starts.size(); ++i) x[starts[i]].setConstant(kNaN);
  for (BoundedVector& state : x)
    if (state.tail<2>().norm() < options.min_speed_mps) state.setConstant(kNaN);
}

Recording make_recording(const Target& target, const GeographicTrackOptions& options) {
  const GeographicLib::LocalCartesian frame = local_frame(target);
  Recording recording;
  recording.measured = {"east_m", "north_m"};
  recording.truth_space = &plane_space();
  recording.truth.resize(1);
  recording.truth[0].track = static_cast<int>(target.number);
  for (const Fix& fix : target.fixes) {
    Measurement measurement;
    measurement.time_s = fix.time_s;
    measurement.z = BoundedVector::Constant(2, kNaN);
    double up_m = 0.0;
    if (!fix.is_missing())
      frame.Forward(fix.latitude_deg, fix.longitude_deg, 0.0, measurement.z[0], measurement.z[1], up_m);
    BoundedVector x = BoundedVector::Constant(4, kNaN);
    x.head<2>() = measurement.z;
    recording.counts.missing += measurement.is_missing();
    recording.measurements.push_back(std::move(measurement));
    recording.truth[0].x.push_back(std::move(x));
  }
  recording.counts.repeated = target.repeated;
  recording.counts.glitches = target.glitches;
  if (options.recorded_velocity) recording.counts.wrong_velocities = target.wrong_velocities;
  complete_truth(target, options, recording.truth[0].x);
  return recording;
}

GeographicTracks read_tracks(CsvReader csv, const GeographicTrackOptions& options) {
  GeographicTracks tracks;
  GeographicTrackOptions believed = options;
  believed.recorded_velocity &= find_columns(csv).speed >= 0;
  for (Target& target : read_targets(csv)) {
    if (std::isfinite(options.max_speed_mps)) remove_glitches(target, options.max_speed_mps);
    remove_wrong_velocities(target, options.max_speed_mps);
    const auto usable =
        std::count_if(target.fixes.begin(), target.fixes.end(), [](const Fix& fix) { return !fix.is_missing(); });
    if (usable < kFewestRows)
      ++tracks.left_out;
    else
      tracks.recordings.push_back(make_recording(target, believed));
  }
  if (tracks.recordings.empty())
    throw InputError(csv.name(), "has no track to follow", fmt::format("at least {} usable rows of one", kFewestRows));
  return tracks;
}

}  // namespace

bool is_geographic_track(const std::filesystem::path& path) {
  std::error_code unknown;
  if (!std::filesystem::is_regular_file(path, unknown)) return false;  // a pipe can be read only once
  return CsvReader(path).column("latitude_deg") >= 0;
}

GeographicTracks read_geographic_tracks(const std::filesystem::path& path, const GeographicTrackOptions& options) {
  return read_tracks(CsvReader(path), options);
}

GeographicTracks read_geographic_tracks(std::istream& stream, const std::string& name,
                                        const GeographicTrackOptions& options) {
  return read_tracks(CsvReader(stream, name), options);
}

}  // namespace truebearing
