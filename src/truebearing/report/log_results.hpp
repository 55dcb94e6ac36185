// SPDX-License-Identifier: Apache-2.0
// What a log says without its truth, as a page needs it: read from the JSON that `track --json` writes of one that has
// none, and from what results of one that has a truth hold of it (`on_log`).
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "truebearing/report/foretelling_results.hpp"
#include "truebearing/report/results.hpp"

namespace truebearing {

struct LogTracker {
  std::string name, no_track;  ///< why it began none; empty where it did
  double steps = kNaN;
  double nis_steps = kNaN, nis_ratio = kNaN, nis_low = kNaN, nis_high = kNaN;
  double correlation = kNaN, correlation_limit = kNaN;
  std::vector<std::pair<std::string, double>> counts;  ///< of what was not used, by why

  /// [innovation]: of the first component in standard deviations, NIS, its degrees of freedom; 1 where it was used.
  std::vector<double> time_s, sigmas, nis, freedom, used;

  struct Last {
    double track = kNaN, time_s = kNaN;
    std::string status;
    std::vector<std::pair<std::string, double>> estimate, sigma;  ///< by component
  };
  std::vector<Last> last;

  struct NotUsed {
    double time_s = kNaN;
    std::string why;
    double nis = kNaN;
  };
  std::vector<NotUsed> not_used;
};

struct LogEvent {
  std::string tracker, event;
  double time_s = kNaN, value = kNaN;
};

struct LogResults {
  std::string study, log, version;
  double measurements = kNaN, missing = kNaN, repeated = kNaN;
  double run = kNaN;  ///< of a truth that is measured afresh in each
  std::vector<std::string> warnings;
  std::vector<LogTracker> trackers;
  std::vector<LogEvent> events;
  std::vector<ForetellingResults> foretelling;
  ResultPicture picture;  ///< without a track where the results draw them beside the truth
};

/// Is this such a JSON, and not that of a comparison?
bool is_log_results(std::string_view json, const std::string& file);
/// Throws InputError that names the file, and the key where one is missing or of the wrong type.
LogResults parse_log_results(std::string_view json, const std::string& file);
LogResults read_log_results(const ResultReader& json);

}  // namespace truebearing
