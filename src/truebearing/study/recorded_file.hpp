// SPDX-License-Identifier: Apache-2.0
// A recorded track that a study is compared on: a measurement log with truth, which every run measures afresh with the
// log's own sigma, or replays where it carries none; a line array's snapshot log with truth, which every run replays; or
// positions on the globe (recording/geographic_track.hpp), which every run measures
// afresh as the study's table [recorded] says:
//   position_sigma_m                             of a sensor that measures the position per axis; or
//   range_sigma_m, bearing_sigma_deg, site       of one that stands `site` = [East, North] m from the track's middle
//   elevation_sigma_deg                          with these in space, where `site` is [East, North, up]
//   max_speed_mps, min_speed_mps, max_gap_periods  what of the track is believed and scored; optional
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "truebearing/io/table_reader.hpp"
#include "truebearing/recording/geographic_track.hpp"
#include "truebearing/recording/recording_options.hpp"
#include "truebearing/simulation/recorded_scenario.hpp"

namespace truebearing {

struct RecordedSpec {
  RecordedSensor sensor;
  GeographicTrackOptions track;
};

RecordedSpec read_recorded_spec(TableReader table);

/// The study's table [log], which says how logs are read that it is given: `columns` = { name in the file = name here },
/// `sort_window_s`, `late.keep_s`, `track`; all optional.
RecordingOptions read_log_table(TableReader table);

class RecordedFile final : public Scenario {
 public:
  /// The file is read when it is first needed: a study is trained and applied without what it is compared on.
  /// `trained_on` says what is measured, and whether measurements carry their sigma; it must outlive this. `study` is
  /// for messages.
  RecordedFile(std::filesystem::path file, std::optional<RecordedSpec> spec, const Scenario& trained_on,
               std::filesystem::path study, RecordingOptions options = {});

  /// These throw InputError where the file is absent or at fault, or holds positions and `spec` is empty.
  Recording simulate(const RunKey& key) const override { return opened().simulate(key); }
  const StateSpace& truth_space() const override { return opened().truth_space(); }
  /// What the study's scenario measures: another file is refused as it is read.
  std::optional<Measured> measured() const override { return trained_on_.measured(); }
  std::optional<std::size_t> different_runs(Role role) const override { return opened().different_runs(role); }
  std::string note() const override;

 private:
  const Scenario& opened() const;
  void open() const;
  void open_log(CsvReader csv) const;
  void open_positions(CsvReader csv) const;

  std::filesystem::path file_;
  std::optional<RecordedSpec> spec_;
  const Scenario& trained_on_;
  std::filesystem::path study_;
  RecordingOptions options_;
  mutable std::mutex mutex_;
  mutable std::unique_ptr<RecordedScenario> scenario_;
  mutable std::string note_;
};

}  // namespace truebearing
