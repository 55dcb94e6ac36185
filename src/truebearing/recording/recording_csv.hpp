// SPDX-License-Identifier: Apache-2.0
// The measurement log: CSV with a time (time_column.hpp), measured columns with their units in the name (`position_m`,
// `range_km`, `bearing_deg`; log_units.hpp), and optionally their standard deviations (`position_sigma_m`), own-ship
// columns (`sensor_east_m`, `sensor_north_m`, and `sensor_east_mps`, `sensor_north_mps`; `sensor_up_m`, and
// `sensor_up_mps`, without which SensorState::up_m is NaN), a guess of what is tracked
// (`guess_range_m`, `guess_range_sigma_m`, and `guess_speed_mps`, `guess_speed_sigma_mps`), the truth
// (`truth_<component>`), and a column that tells targets apart (`vessel`, `track`, `mmsi`, ...). Of several sensors that a
// study knows each row is one's: a column `sensor` names it, or the cells that are filled tell. Other columns are left out
// (log_columns.hpp).
//
// A cell without a finite number makes the measurement missing, and so does what cannot be: a range or a frequency
// that is not above 0, a bearing of 511 degrees, by which AIS says that there is none, or of 999 or 9999 of either sign
// in a log that has no others beyond 360, a position at 0, 0 after others far from there. A row that says the same as
// the one before is dropped. All are counted. A truth that gives positions only is completed by velocity_truth().
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <istream>
#include <queue>
#include <string>
#include <vector>

#include "truebearing/core/constants.hpp"
#include "truebearing/io/csv.hpp"
#include "truebearing/recording/log_columns.hpp"
#include "truebearing/recording/recording.hpp"
#include "truebearing/recording/recording_options.hpp"
#include "truebearing/recording/time_column.hpp"

namespace truebearing {

/// What was found while a log was read, beside what Recording::Counts tells.
struct LogFindings {
  std::vector<std::string> left_out;  ///< names of columns
  std::size_t late = 0;               ///< rows put in order
  std::size_t impossible = 0;         ///< measurements that cannot be
  std::size_t not_available = 0;      ///< measurements that say that there is none
  std::size_t at_zero = 0;            ///< plots at 0, 0 of a target that is not near
  std::size_t too_far = 0;            ///< rows that measure what lies farther than kFarthest_m
  std::size_t of_others = 0;          ///< rows of other targets

  /// For the user, in one line without the file's name; empty where nothing was found.
  std::string note() const;
};

/// A log row by row, in constant memory, as a stream needs it.
class MeasurementLog {
 public:
  /// Reads the header, which has the names that the options give it: with_names(). Throws InputError that names file, line
  /// and column, as next() does.
  explicit MeasurementLog(CsvReader csv, RecordingOptions options = {});

  const std::vector<std::string>& measured() const { return columns_and_counts_.measured; }
  /// nullptr where there is no truth.
  const StateSpace* truth_space() const { return layout_.truth_space; }
  const LogLayout& layout() const { return layout_; }

  /// Moves to the next measurement in the order of times; false at the end. Waits for no row beyond it, unless
  /// options.sort_window_s asks for it. Throws where the log has none at all.
  bool next();
  const Measurement& measurement() const { return row_.measurement; }
  /// The truth as the row gives it, NaN where it does not; without completed velocities.
  const BoundedVector& truth() const { return row_.truth; }

  const std::string& name() const { return csv_.name(); }
  /// Of the rows so far.
  const Recording::Counts& counts() const { return columns_and_counts_.counts; }
  const LogFindings& findings() const { return findings_; }
  /// Whether to ask for the next row may have to wait for who writes the log.
  bool may_wait() const { return csv_.may_wait(); }

  /// Appends the row to a recording that began empty; complete() after the last one gives it what the columns and all
  /// rows together say.
  void append_to(Recording& recording) const;
  void complete(Recording& recording) const;

 private:
  struct Row {
    double time_s = 0.0;
    std::uint64_t number = 0;   // of the file: rows of one time stay in its order
    std::size_t line = 0;       // of the file
    std::vector<double> cells;  // of the columns that are read
    Measurement measurement;
    BoundedVector truth;
    bool operator>(const Row& other) const {
      return time_s > other.time_s || (time_s == other.time_s && number > other.number);
    }
  };

  bool read_row();
  bool is_of_target();
  void check_lateness(double time_s);
  Measurement read_measurement(const std::vector<double>& cells, double time_s);
  double greatest_lateness(double time_s);
  void remove_impossible(Measurement& measurement);
  void look_at_place(Measurement& measurement);
  void find_sources();
  std::size_t source_of_row(const Measurement& measurement) const;
  void keep_own(Measurement& measurement) const;
  void check_end() const;

  CsvReader csv_;
  RecordingOptions options_;
  TimeColumn time_;
  LogLayout layout_;
  Recording columns_and_counts_;      // without measurements
  std::vector<std::size_t> columns_;  // those that are read
  std::vector<std::size_t> cell_of_;  // by column of the file: its place among them
  std::vector<std::vector<Eigen::Index>>
      places_of_;  // of several sensors: of its components among all that is measured
  std::priority_queue<Row, std::vector<Row>, std::greater<>> waiting_;
  Row row_;
  double first_time_s_ = 0.0;
  double latest_time_s_ = 0.0;
  std::uint64_t rows_ = 0;
  std::uint64_t given_ = 0;
  bool times_differ_ = false;
  bool is_unwrapped_ = false;  // the last bearing was beyond 360 degrees
  Eigen::Vector2d last_place_m_{kNaN, kNaN};
  double last_stride_m_ = kNaN;  // to it, from the place before
  std::string target_;           // whose rows are read, once it is known
  LogFindings findings_;
};

/// Reads a log; "-" is standard input. Throws InputError that names file, line and column.
Recording read_recording(const std::filesystem::path& path, const RecordingOptions& options = {},
                         LogFindings* findings = nullptr);
/// The same for a stream; `name` stands for the file in messages.
Recording read_recording(std::istream& stream, const std::string& name, const RecordingOptions& options = {},
                         LogFindings* findings = nullptr);
/// The same for a file that is open and has the names that the options give it: with_names().
Recording read_recording(CsvReader csv, const RecordingOptions& options, LogFindings* findings = nullptr);

/// The text of a log, which reads back as the same recording. Sigma and sensor columns are written where any
/// measurement has them. Throws InputError where there are several true tracks, which a log cannot hold.
std::string write_recording(const Recording& recording);

}  // namespace truebearing
