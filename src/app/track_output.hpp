// SPDX-License-Identifier: Apache-2.0
// What `truebearing track` writes for programs, as it comes: step records and events.
#pragma once

#include <string>

#include "app/output.hpp"
#include "truebearing/evaluation/tracker_set.hpp"
#include "truebearing/io/csv.hpp"
#include "truebearing/tracker/step_log.hpp"

namespace truebearing {

/// Writes the records of all trackers whose state is the largest, as they come.
class RecordOutput {
 public:
  /// measured: columns of the log, as many as an innovation has components; or 0. sources: of several sensors. late: rows may be
  /// written again, marked as revised.
  RecordOutput(const std::string& path, const TrackerSet& trackers, int measured, const std::vector<Source>& sources,
               bool late);

  /// The tracks of several are only in order when all are there.
  void wait_for_all() { waits_ = true; }

  void add(const std::string& name, const StepRecord& record, bool revised = false);
  void flush() { output_.flush(); }
  void finish();

 private:
  OutputStream output_;
  const StateSpace* space_;
  StepLogWriter writer_;
  bool waits_ = false;
};

/// What the trackers notice, as CSV.
class EventOutput {
 public:
  explicit EventOutput(const std::string& path);

  void add(const std::string& tracker, const TrackEvent& event);
  void flush();
  void finish();

 private:
  OutputStream output_;
  CsvWriter csv_;
};

}  // namespace truebearing
