// The measurement log: CSV with `time_s`, measured columns with their units in the name (`position_m`, `bearing_deg`),
// and optionally their standard deviations (`position_sigma_m`), own-ship columns (`sensor_east_m`, `sensor_north_m`,
// and `sensor_east_mps`, `sensor_north_mps`), a guess of what is tracked (`guess_range_m`, `guess_range_sigma_m`, and
// `guess_speed_mps`, `guess_speed_sigma_mps`) and the truth (`truth_<component>`). Degrees become radians.
//
// An empty, NaN or infinite cell makes the measurement missing. A row identical to the one before is dropped. Both are
// counted. A truth that gives positions only is completed by velocity_truth().
#pragma once

#include <filesystem>
#include <istream>
#include <memory>
#include <string>
#include <vector>

#include "truebearing/recording/recording.hpp"

namespace truebearing {

/// A log row by row, as it comes: what it holds in memory does not grow with the log.
class RecordingReader {
 public:
  /// Opens a log, or standard input where the path is "-", and reads its header. Throws InputError that names file, line
  /// and column, as all members do.
  explicit RecordingReader(const std::filesystem::path& path);
  /// The same for a stream that outlives the reader; `name` stands for the file in messages.
  RecordingReader(std::istream& stream, const std::string& name);
  RecordingReader(RecordingReader&&) noexcept;
  ~RecordingReader();

  const std::vector<std::string>& measured() const;
  const StateSpace* truth_space() const;  ///< nullptr where the log has no truth

  /// Moves to the next measurement; false at the end. Throws where the log has none at all.
  bool next();
  const Measurement& measurement() const;
  /// The true state with it, NaN where a component is not given; empty where the log has no truth.
  const BoundedVector& truth() const;
  /// Of the rows so far.
  const Recording::Counts& counts() const;
  /// Whether to ask for the next row may have to wait for who writes the log.
  bool may_wait() const;

  /// Appends the row to a recording that began empty; complete() after the last one gives it what the columns and all
  /// rows together say.
  void append_to(Recording& recording) const;
  void complete(Recording& recording) const;

 private:
  struct Log;
  std::unique_ptr<Log> log_;
};

/// Reads a log; "-" is standard input. Throws InputError that names file, line and column.
Recording read_recording(const std::filesystem::path& path);
/// The same for a stream; `name` stands for the file in messages.
Recording read_recording(std::istream& stream, const std::string& name);

/// The text of a log, which reads back as the same recording. Sigma and sensor columns are written where any
/// measurement has them. Throws InputError where there are several true tracks, which a log cannot hold.
std::string write_recording(const Recording& recording);

}  // namespace truebearing
