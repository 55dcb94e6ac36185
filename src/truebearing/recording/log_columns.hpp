// SPDX-License-Identifier: Apache-2.0
// What each column of a recorded file is taken for. Names say the quantity and its unit (log_units.hpp); a column that
// is none of those known is left out, unless its name is so near to one that the file lacks that it was probably meant.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "truebearing/core/error.hpp"
#include "truebearing/core/state_space.hpp"
#include "truebearing/io/csv.hpp"
#include "truebearing/recording/log_units.hpp"
#include "truebearing/recording/recording_options.hpp"
#include "truebearing/recording/time_column.hpp"

namespace truebearing {

enum class ColumnRole {
  left_out,
  time,
  measured,
  sigma,
  sensor,
  source,
  guess,
  truth,
  target,
  position,
  altitude,
  velocity
};

/// "own ship", "standard deviation", ...
std::string_view to_string(ColumnRole role);

struct LogColumn {
  std::size_t index = 0;
  ColumnRole role = ColumnRole::left_out;
  std::string
      quantity{};  ///< its name here: "range_m", "bearing_sigma_deg", "east_mps" of truth_east_kn; empty if left out
  double factor = 1.0;  ///< a number of the column times this is one of the program
};

/// Which column of a measurement log means what.
struct LogLayout {
  std::vector<LogColumn> columns;  ///< all of the file
  std::vector<LogColumn> z;
  std::vector<LogColumn> sigma;                      ///< as long as z, or empty
  std::vector<LogColumn> sensor;                     ///< none, position, or position and velocity
  std::optional<LogColumn> sensor_up, sensor_climb;  ///< own ship's height, and with it its vertical speed
  std::vector<LogColumn> guess;                      ///< none, range, or range and speed, with their sigmas
  std::vector<std::optional<LogColumn>> truth;       ///< by component of the truth space
  const StateSpace* truth_space = nullptr;
  std::optional<std::size_t> target;  ///< the column that tells targets apart
  std::optional<std::size_t> source;  ///< the column that names which of several sensors a row is of
  std::vector<InputError> faults;     ///< why the file cannot be read; mostly empty

  std::vector<std::string> measured() const;
  /// Names of the columns that are left out.
  std::vector<std::string> left_out(const CsvReader& csv) const;
};

/// The column of a measured one's standard deviations: "position_m" -> "position_sigma_m".
std::string sigma_name(const std::string& measured);

/// `csv` has the names that the options give it: with_names().
LogLayout read_log_layout(const CsvReader& csv, const TimeColumn& time, const RecordingOptions& options);

/// The file with the names that the options give its columns. Those without one keep theirs and are left out. Throws
/// InputError where the file has no such column.
CsvReader with_names(CsvReader csv, const RecordingOptions& options);
/// The same of a file that is to be opened: CSV, JSON lines, or one of Debrief's as the table that says the same
/// (debrief_replay.hpp); "-" is standard input. Throws InputError where it cannot be.
CsvReader open_table(const std::filesystem::path& path, const RecordingOptions& options = {});

/// The column STEM_UNIT in a unit of that dimension, of which a file has one as a rule.
std::optional<LogColumn> find_column(const CsvReader& csv, std::string_view stem, Dimension dimension);

/// Whether the options leave that column out.
bool is_unwanted(const std::string& column, const RecordingOptions& options);

/// The column that tells targets apart: vessel, flight or track, else mmsi, icao24 or callsign. Throws InputError where
/// there are two of the first three.
std::optional<std::size_t> find_target_column(const CsvReader& csv, const RecordingOptions& options);

/// The name of the current row's target; empty where it is not told. Throws InputError where the cell is a fraction,
/// which is a measurement and no name.
std::string read_target_name(const CsvReader& csv, std::size_t column);

/// "columns left out: snr_db, remark"; empty where there are none.
std::string left_out_note(const std::vector<std::string>& names);

/// The name that column `index` was probably meant to have, of those that a log may have and this file lacks.
std::string meant_name(const CsvReader& csv, std::size_t index, const std::vector<std::string>& known);

}  // namespace truebearing
