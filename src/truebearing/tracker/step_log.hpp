// SPDX-License-Identifier: Apache-2.0
// The step log: what trackers did, as CSV. It is what `truebearing track -o` writes, and how a tracker that runs
// elsewhere (an existing system, MATLAB, Stone Soup) joins the house. Columns: `time_s`, `track`, `x_<component>`,
// `P_<i>_<j>` (upper triangle, from 1), and where they exist `tracker`, `status`, `sensor`, `z_<i>`, `nu_<i>`, `S_<i>_<j>`,
// `truth_<component>`. Of sensors that measure less than others the last cells of z, nu and S are empty. In a log with a
// column `revised` a row earlier than the one before it is a late one, after which those of later times follow once more,
// with 1 in that column: what stood there of these times is forgotten, so that of each the last revision is read.
#pragma once

#include <filesystem>
#include <istream>
#include <string>
#include <vector>

#include "truebearing/io/csv.hpp"
#include "truebearing/tracker/step_record.hpp"

namespace truebearing {

struct StepLog {
  const StateSpace* space = nullptr;
  std::vector<StepRecord> records;  ///< in the order of the file, times not decreasing; of revised rows the last
  bool has_innovation = false;
  /// By record, NaN where a cell is empty: the measurement (no components where the log has no columns z), and the
  /// truth of these components (none where it has no columns truth_).
  std::vector<BoundedVector> z;
  std::vector<std::string> truth_components;
  std::vector<BoundedVector> truth;
};

/// The records of `tracker`, or of the whole file where that is empty. An innovation block is read where z, nu and S
/// are all there. Throws InputError that names file and line: decreasing times, a covariance that is none, missing
/// columns.
StepLog read_step_log(const std::filesystem::path& path, const std::string& tracker = {});
StepLog read_step_log(std::istream& stream, const std::string& name, const std::string& tracker = {});

/// Whether the file is a regular one whose columns are those of a step log: a track, a state and its P.
bool is_step_log(const std::filesystem::path& path);
/// The names in the column `tracker`, in the order in which they come; none where there is no such column.
std::vector<std::string> trackers_in_step_log(const std::filesystem::path& path);

/// Builds a step log. All records must be of one state space; blocks that a record has not become empty cells.
class StepLogWriter {
 public:
  /// measurements: size of z; 0 leaves the innovation's columns out. Innovations of fewer components fill the first
  /// ones.
  struct Columns {
    int measurements = 0;
    std::vector<std::string> sensors{};  ///< names of several, by StepRecord::source; a column says which then
    bool revised = false;                ///< a column says whether a row stands in place of one before it
  };
  StepLogWriter(const StateSpace& space, Columns columns);
  StepLogWriter(const StateSpace& space, int measurements) : StepLogWriter(space, Columns{measurements}) {}

  void add(const std::string& tracker, const StepRecord& record, bool revised = false);
  /// Puts the rows in the order of their times, which a log must have; rows of one time stay as they were added.
  void sort_by_time();
  std::string str() const;
  /// The rows since the last take(), which are then forgotten: with the header before the first of them. So a log can
  /// be written as its records come.
  std::string take();

 private:
  int states_;
  Columns columns_;
  CsvWriter csv_;
  std::string header_;  // until it is taken
  struct Row {
    double time_s;
    std::string text;
  };
  std::vector<Row> rows_;
};

}  // namespace truebearing
