// SPDX-License-Identifier: Apache-2.0
// What a recorded file holds and whether it can be read: what each column is taken for, how often rows come, and what is
// odd about them. For `truebearing check LOG.csv`.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "truebearing/core/constants.hpp"
#include "truebearing/recording/recording_options.hpp"

namespace truebearing {

struct ColumnReport {
  std::string name;       ///< in the file, or as it was renamed
  std::string taken_for;  ///< "measured range_m", "own ship sensor_east_m", "left out"
  std::string unit;       ///< that the name ends in: "km"; empty of what has none
  bool is_used = false;
  std::size_t missing = 0;
  std::size_t unreadable = 0;          ///< cells that are neither number nor missing
  double least = 0.0, greatest = 0.0;  ///< in the column's own unit; NaN where there is no number
};

struct LogReport {
  std::string log;
  char separator = ',';
  std::size_t rows = 0;
  std::size_t targets = 0;  ///< that a column tells apart; 0 where none does
  std::vector<ColumnReport> columns;

  double first_s = kNaN, last_s = kNaN;  ///< earliest and latest time; NaN where there is none
  double median_period_s = 0.0, least_period_s = 0.0,
         greatest_period_s = 0.0;    ///< of a target's rows; NaN of fewer than 2
  std::size_t gaps = 0;              ///< periods of more than three medians
  double longest_gap_after_s = 0.0;  ///< the time at which the greatest period begins
  std::size_t late = 0;              ///< rows earlier than one before them
  std::size_t repeated = 0;          ///< rows of one target that measure the same as the one before at the same time

  std::vector<std::string> oddities;  ///< what may be wrong
  std::vector<std::string> faults;    ///< why it cannot be read; empty where it can

  bool is_usable() const { return faults.empty(); }
};

/// Reads the file twice where it is a regular one: to describe it, and as the trackers' reader would. Throws InputError
/// where it cannot be opened or has no header.
LogReport check_log(const std::filesystem::path& path, const RecordingOptions& options);

}  // namespace truebearing
