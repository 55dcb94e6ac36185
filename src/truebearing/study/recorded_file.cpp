// SPDX-License-Identifier: Apache-2.0
#include "truebearing/study/recorded_file.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <utility>

#include "truebearing/core/angle.hpp"
#include "truebearing/array/recorded_array.hpp"
#include "truebearing/core/error.hpp"
#include "truebearing/recording/recording_csv.hpp"
#include "truebearing/recording/snapshot_log.hpp"
#include "truebearing/study/measured_check.hpp"

namespace truebearing {
namespace {

std::string note_of(const std::string& file, const GeographicTracks& tracks) {
  Recording::Counts sum;
  std::size_t rows = 0;
  for (const Recording& recording : tracks.recordings) {
    rows += recording.measurements.size();
    sum.missing += recording.counts.missing;
    sum.glitches += recording.counts.glitches;
    sum.repeated += recording.counts.repeated;
    sum.wrong_velocities += recording.counts.wrong_velocities;
  }
  const std::string left_out =
      tracks.left_out == 0 ? ""
                           : fmt::format(" ({} left out with fewer than {} usable rows)", tracks.left_out, kFewestRows);
  const std::string wrong_velocities =
      sum.wrong_velocities == 0 ? "" : fmt::format(", {} impossible velocities", sum.wrong_velocities);
  const auto more = [](std::size_t count, const char* what) {
    return count == 0 ? std::string() : fmt::format(", {} {}", count, what);
  };
  return fmt::format(
      "{}: tracks: {}{}; {} measurements, {} missing, {} of them glitches, {} repeated rows dropped{}{}{}{}", file,
      tracks.recordings.size(), left_out, rows, sum.missing, sum.glitches, sum.repeated, wrong_velocities,
      more(tracks.not_available, "not available"), more(tracks.null_island, "at 0, 0"),
      more(tracks.late, "late rows put in order"));
}

bool is_scored(const Recording& recording) {
  return std::any_of(recording.truth[0].x.begin(), recording.truth[0].x.end(),
                     [](const BoundedVector& x) { return x.allFinite(); });
}

// In which other unit the speeds would be scored, as a question; empty where in none.
std::string unit_in_question(const GeographicTracks& tracks, const GeographicTrackOptions& options) {
  constexpr double kLongPeriod_s = 100.0, kMilli = 1000.0;
  const auto is_plausible = [&](double speed_mps) {
    return speed_mps >= options.min_speed_mps && speed_mps <= options.max_speed_mps;
  };
  const std::vector<Measurement>& rows = tracks.recordings.front().measurements;
  const double period_s = (rows.back().time_s - rows.front().time_s) / static_cast<double>(rows.size());
  if (period_s >= kLongPeriod_s && is_plausible(kMilli * tracks.fastest_mps))
    return "; are its times in milliseconds, time_ms?";
  if (tracks.widest_deg <= 2.0 * kPi && is_plausible(degrees(tracks.fastest_mps)))
    return "; are its angles in radians, latitude_rad?";
  return {};
}

// Why nothing of the tracks is scored; empty where something is.
std::string unscored_note(const GeographicTracks& tracks, const GeographicTrackOptions& options) {
  if (std::any_of(tracks.recordings.begin(), tracks.recordings.end(), is_scored)) return {};
  if (tracks.fastest_mps >= options.min_speed_mps) return "no step is scored: no velocity is known";
  return fmt::format("no step is scored: all are slower than min_speed_mps = {:g} (fastest {:.3g} m/s){}",
                     options.min_speed_mps, tracks.fastest_mps, unit_in_question(tracks, options));
}

}  // namespace

RecordedSpec read_recorded_spec(TableReader table) {
  RecordedSpec spec;
  if (table.has("range_sigma_m")) {
    spec.sensor.output = RecordedSensor::Output::range_bearing;
    spec.sensor.sigma_m = table.number("range_sigma_m", kPositive);
    spec.sensor.bearing_sigma_rad = radians(table.number("bearing_sigma_deg", {0.0, 90.0, true}));
    const bool looks_up = table.has("elevation_sigma_deg");
    if (looks_up) spec.sensor.elevation_sigma_rad = radians(table.number("elevation_sigma_deg", {0.0, 90.0, true}));
    const std::vector<double> site_m = table.numbers("site", looks_up ? 3 : 2);
    spec.sensor.site_m << site_m[0], site_m[1];
    if (looks_up) spec.sensor.site_up_m = site_m[2];
  } else {
    spec.sensor.sigma_m = table.number("position_sigma_m", kPositive);
  }
  spec.track.max_speed_mps = table.number_or("max_speed_mps", spec.track.max_speed_mps, kPositive);
  spec.track.recorded_velocity = table.choice_or("velocity", {"slope", "recorded"}, "slope") == "recorded";
  spec.track.min_speed_mps = table.number_or("min_speed_mps", spec.track.min_speed_mps, kNonNegative);
  spec.track.max_gap_periods = table.number_or("max_gap_periods", spec.track.max_gap_periods, {1.0, 1e300});
  table.finish();
  return spec;
}

RecordingOptions read_log_table(TableReader table) {
  RecordingOptions options;
  if (auto columns = table.table_if_present("columns"))
    for (const std::string& name : columns->keys()) options.columns.emplace_back(name, columns->text(name));
  options.sort_window_s = table.number_or("sort_window_s", 0.0, kNonNegative);
  if (auto late = table.table_if_present("late")) {
    options.late_keep_s = late->number("keep_s", kPositive);
    late->finish();
  }
  options.target = table.text_or("track", "");
  table.finish();
  return options;
}

RecordedFile::RecordedFile(std::filesystem::path file, std::optional<RecordedSpec> spec, const Scenario& trained_on,
                           std::filesystem::path study, RecordingOptions options)
    : file_(std::move(file)),
      spec_(std::move(spec)),
      trained_on_(trained_on),
      study_(std::move(study)),
      options_(std::move(options)) {}

std::string RecordedFile::note() const {
  opened();
  return note_;
}

const Scenario& RecordedFile::opened() const {
  const std::lock_guard lock(mutex_);
  if (!scenario_) open();
  return *scenario_;
}

void RecordedFile::open() const {
  if (is_snapshot_log(file_)) {
    Recording recording = read_snapshot_log(file_);
    check_measured(recording.measured, trained_on_, file_.string());
    if (!recording.truth_space)
      throw InputError(file_.string(), "has no truth to score against", "a dataset truth_angle_deg");
    note_ = fmt::format("{}: targets: {}; {} intervals, {} missing, {} repeated ones dropped; every run replays them",
                        file_.string(), recording.truth.size(), recording.measurements.size(), recording.counts.missing,
                        recording.counts.repeated);
    if (const std::string note = array_of(recording).note(); !note.empty())
      note_ += fmt::format("\n{}: {}", file_.string(), note);
    scenario_ = std::make_unique<RecordedScenario>(std::move(recording));
    return;
  }
  CsvReader csv = open_table(file_, options_);
  if (is_geographic_track(csv))
    open_positions(std::move(csv));
  else
    open_log(std::move(csv));
}

void RecordedFile::open_log(CsvReader csv) const {
  const std::string name = csv.name();
  LogFindings findings;
  Recording recording = read_recording(std::move(csv), options_, &findings);
  check_measured(recording.measured, trained_on_, name);
  if (!recording.truth_space)
    throw InputError(name, "has no truth to score against", "a log with truth_ columns, or positions on the globe");
  const std::string found = findings.note(), reason = reason_to_replay(recording);
  if (!found.empty()) note_ = name + ": " + found;
  if (reason.empty()) {
    scenario_ = std::make_unique<RecordedScenario>(std::move(recording));
    return;
  }
  note_ += fmt::format("{}{}: {}: every run replays them", note_.empty() ? "" : "\n", name, reason);
  scenario_ = std::make_unique<RecordedScenario>(RecordedScenario::replayed(std::move(recording)));
}

void RecordedFile::open_positions(CsvReader csv) const {
  const std::string name = csv.name();
  if (!spec_)
    throw InputError(name, "holds positions, and the study does not say how they are measured",
                     "a table [recorded] with position_sigma_m in " + study_.string());
  RecordedSensor sensor = spec_->sensor;
  GeographicTrackOptions track = spec_->track;
  track.in_space = sensor.in_space = trained_on_.truth_space() == space_space();
  const bool looks_up = sensor.elevation_sigma_rad > 0.0;
  if (sensor.output == RecordedSensor::Output::range_bearing && looks_up != sensor.in_space)
    throw InputError(
        study_.string() + ": recorded",
        looks_up ? "tells an elevation, and the study is in the plane"
                 : "tells no elevation, and the study is in space",
        looks_up ? "no elevation_sigma_deg" : "elevation_sigma_deg beside range_sigma_m, and site = [East, North, up]");
  check_measured(sensor.measured().components, trained_on_, name);
  sensor.reported = trained_on_.reports_sigma();
  GeographicTracks tracks = read_geographic_tracks(std::move(csv), track, options_);
  note_ = note_of(name, tracks);
  if (tracks.has_altitude && !track.in_space) note_ += ", altitudes not used in the plane";
  if (const std::string unscored = unscored_note(tracks, spec_->track); !unscored.empty())
    note_ += fmt::format("\n{}: {}", name, unscored);
  scenario_ = std::make_unique<RecordedScenario>(std::move(tracks.recordings), sensor);
}

}  // namespace truebearing
