#include "truebearing/study/recorded_file.hpp"

#include <fmt/format.h>
#include <utility>

#include "truebearing/core/angle.hpp"
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
  return fmt::format("{}: tracks: {}{}; {} measurements, {} missing, {} of them glitches, {} repeated rows dropped{}",
                     file, tracks.recordings.size(), left_out, rows, sum.missing, sum.glitches, sum.repeated,
                     wrong_velocities);
}

}  // namespace

RecordedSpec read_recorded_spec(TableReader table) {
  RecordedSpec spec;
  if (table.has("range_sigma_m")) {
    spec.sensor.output = RecordedSensor::Output::range_bearing;
    spec.sensor.sigma_m = table.number("range_sigma_m", kPositive);
    spec.sensor.bearing_sigma_rad = radians(table.number("bearing_sigma_deg", {0.0, 90.0, true}));
    const std::vector<double> site_m = table.numbers("site", 2);
    spec.sensor.site_m << site_m[0], site_m[1];
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

RecordedFile::RecordedFile(std::filesystem::path file, std::optional<RecordedSpec> spec, const Scenario& trained_on,
                           std::filesystem::path study)
    : file_(std::move(file)), spec_(std::move(spec)), trained_on_(trained_on), study_(std::move(study)) {}

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
    scenario_ = std::make_unique<RecordedScenario>(std::move(recording));
    return;
  }
  if (!is_geographic_track(file_)) {
    Recording recording = read_recording(file_);
    check_measured(recording.measured, trained_on_, file_.string());
    scenario_ = std::make_unique<RecordedScenario>(std::move(recording));
    return;
  }
  if (!spec_)
    throw InputError(file_.string(), "holds positions, and the study does not say how they are measured",
                     "a table [recorded] with position_sigma_m in " + study_.string());
  RecordedSensor sensor = spec_->sensor;
  check_measured(sensor.measured().components, trained_on_, file_.string());
  sensor.reported = trained_on_.reports_sigma();
  GeographicTracks tracks = read_geographic_tracks(file_, spec_->track);
  note_ = note_of(file_.string(), tracks);
  scenario_ = std::make_unique<RecordedScenario>(std::move(tracks.recordings), sensor);
}

}  // namespace truebearing
