// SPDX-License-Identifier: Apache-2.0
#include "app/check_log.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <set>

#include "app/output.hpp"
#include "truebearing/core/error.hpp"
#include "truebearing/core/printable.hpp"
#include "truebearing/evaluation/text_table.hpp"
#include "truebearing/recording/log_check.hpp"
#include "truebearing/recording/snapshot_log.hpp"
#include "truebearing/tracker/step_log.hpp"

namespace truebearing {
namespace {

constexpr std::size_t kMostShown = 200, kMostColumns = 100;

std::string number(double value) {
  return std::isnan(value) ? "-" : fmt::format("{:.12g}", value);
}

std::string separator_name(char separator) {
  return separator == '\t' ? "tab" : std::string(1, separator);
}

void print_times(const LogReport& report) {
  fmt::print("\ntimes from {} to {} s; period {} s (least {}, greatest {}); {} gaps", number(report.first_s),
             number(report.last_s), number(report.median_period_s), number(report.least_period_s),
             number(report.greatest_period_s), report.gaps);
  if (report.gaps > 0) fmt::print(", the longest after {} s", number(report.longest_gap_after_s));
  fmt::print("\n{} repeated rows, {} late rows\n", report.repeated, report.late);
}

void print_report(const LogReport& report) {
  fmt::print("{}: {} rows", shortened_from_front(printable(report.log), 120), report.rows);
  if (report.targets > 0) fmt::print(" of {} targets", report.targets);
  fmt::print(", cells separated by {}\n\n", separator_name(report.separator));
  std::vector<std::vector<std::string>> table{{"column", "taken for", "unit", "missing", "least", "greatest"}};
  for (std::size_t i = 0; i < std::min(report.columns.size(), kMostColumns); ++i) {
    const ColumnReport& column = report.columns[i];
    table.push_back({shortened(printable(column.name), 40), shortened(printable(column.taken_for), 60),
                     column.unit.empty() ? "-" : column.unit, column.is_used ? fmt::format("{}", column.missing) : "-",
                     number(column.least), number(column.greatest)});
  }
  fmt::print("{}", aligned(table));
  if (report.columns.size() > kMostColumns) fmt::print("and {} columns more\n", report.columns.size() - kMostColumns);
  if (std::isnan(report.first_s))
    fmt::print("\nno times\n");
  else
    print_times(report);
  for (const std::string& oddity : report.oddities)
    fmt::print("odd: {}\n", shortened(printable(oddity), kMostShown - 5));
  for (const std::string& fault : report.faults) fmt::print("fault: {}\n", fault);
  if (report.is_usable()) fmt::print("can be used\n");
}

nlohmann::ordered_json number_or_null(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

std::string report_json(const LogReport& report) {
  nlohmann::ordered_json json{{"log", printable(report.log)},
                              {"usable", report.is_usable()},
                              {"rows", report.rows},
                              {"targets", report.targets},
                              {"separator", std::string(1, report.separator)},
                              {"columns", nlohmann::ordered_json::array()},
                              {"left_out", nlohmann::ordered_json::array()}};
  for (const ColumnReport& column : report.columns) {
    if (!column.is_used) json["left_out"].push_back(printable(column.name));
    json["columns"].push_back({{"name", printable(column.name)},
                               {"taken_for", printable(column.taken_for)},
                               {"unit", column.unit},
                               {"missing", column.missing},
                               {"unreadable", column.unreadable},
                               {"least", number_or_null(column.least)},
                               {"greatest", number_or_null(column.greatest)}});
  }
  json["time_s"] = {{"first", number_or_null(report.first_s)}, {"last", number_or_null(report.last_s)}};
  json["period_s"] = {{"median", number_or_null(report.median_period_s)},
                      {"least", number_or_null(report.least_period_s)},
                      {"greatest", number_or_null(report.greatest_period_s)}};
  json["gaps"] = report.gaps;
  json["late"] = report.late;
  json["repeated"] = report.repeated;
  json["oddities"] = nlohmann::ordered_json::array();
  for (const std::string& oddity : report.oddities) json["oddities"].push_back(printable(oddity));
  json["faults"] = report.faults;
  return json.dump(2) + "\n";
}

}  // namespace

void check_snapshot_log(const std::string& path) {
  const Recording recording = read_snapshot_log(path);
  fmt::print("{}: of a line array: {} intervals, {} missing, {} repeated ones dropped, {} true targets\ncan be used\n",
             shortened_from_front(printable(path), 100), recording.measurements.size(), recording.counts.missing,
             recording.counts.repeated, recording.truth.size());
}

void check_step_log(const std::string& path) {
  const StepLog log = read_step_log(path);
  std::set<int> tracks;
  for (const StepRecord& record : log.records) tracks.insert(record.track);
  const std::vector<std::string> trackers = trackers_in_step_log(path);
  fmt::print("{}: what trackers did (a step log): {} records of {} track{}, from {} to {} s\n",
             shortened_from_front(printable(path), 100), log.records.size(), tracks.size(),
             tracks.size() == 1 ? "" : "s", number(log.records.front().time_s), number(log.records.back().time_s));
  if (!trackers.empty())
    fmt::print("trackers: {}\n", shortened(printable(fmt::format("{}", fmt::join(trackers, ", "))), kMostShown));
  fmt::print("states: {}; {} innovations; {} truth\n", fmt::join(log.space->components, ", "),
             log.has_innovation ? "with" : "without", log.truth_components.empty() ? "without" : "with");
  fmt::print("can be used where a study's scenario is of the kind step_logs\n");
}

void check_log_file(const std::string& path, const LogArguments& reading, const std::string& json) {
  const LogReport report = check_log(path, reading.over({}));
  if (json != "-") print_report(report);
  if (!json.empty()) write_output(json, report_json(report));
  if (!report.is_usable()) throw InputError({}, report.faults.front());
}

}  // namespace truebearing
