// SPDX-License-Identifier: Apache-2.0
#include "truebearing/recording/log_check.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <unordered_map>

#include "truebearing/core/angle.hpp"
#include "truebearing/core/constants.hpp"
#include "truebearing/core/printable.hpp"
#include "truebearing/recording/geographic_track.hpp"
#include "truebearing/recording/recording_csv.hpp"

namespace truebearing {
namespace {

constexpr std::size_t kFewestValues = 20;  // of which something is said

/// What is measured in the rows of one target.
struct TargetRows {
  double time_s = kNaN;       // of the last row
  std::vector<double> cells;  // measured ones of it
  std::size_t equal = 0;      // rows in a row that measured the same
};

// Goes over the rows of a file and counts, whatever they hold.
class LogSurvey {
 public:
  LogSurvey(CsvReader csv, const RecordingOptions& options) : csv_(std::move(csv)), options_(options) {
    report_.log = csv_.name();
    report_.separator = csv_.separator();
    read_columns();
    describe_columns();
  }

  LogReport report() && {
    read_rows();
    summarise_times();
    look_at_values();
    return std::move(report_);
  }

 private:
  void fault(const InputError& error) {
    const std::string what = error.what();
    if (std::find(report_.faults.begin(), report_.faults.end(), what) == report_.faults.end())
      report_.faults.push_back(what);
  }

  void read_columns() try {
    time_ = TimeColumn(csv_);
    if (is_geographic_track(csv_)) {
      columns_ = geographic_columns(csv_, options_);
    } else {
      LogLayout layout = read_log_layout(csv_, *time_, options_);
      columns_ = std::move(layout.columns);
      for (const InputError& error : layout.faults) fault(error);
    }
    target_ = find_target_column(csv_, options_);
  } catch (const InputError& error) {
    fault(error);
  }

  static bool holds_numbers(const LogColumn& column) {
    return column.role != ColumnRole::target && column.role != ColumnRole::source;
  }

  void describe_columns() {
    for (std::size_t index = columns_.size(); index < csv_.header().size(); ++index)
      columns_.push_back({index, {}, {}});
    for (const LogColumn& column : columns_) {
      ColumnReport one;
      one.name = csv_.header()[column.index];
      one.is_used = column.role != ColumnRole::left_out;
      one.taken_for = std::string(to_string(column.role));
      const bool has_quantity = holds_numbers(column) && column.role != ColumnRole::time;
      if (one.is_used && has_quantity) one.taken_for += " " + column.quantity;
      const NameAndUnit name = apart(one.name);
      if (one.is_used && name.unit) one.unit = std::string(name.unit->suffix);
      one.least = one.greatest = kNaN;
      report_.columns.push_back(std::move(one));
      const bool is_measured = column.role == ColumnRole::measured || column.role == ColumnRole::position;
      if (is_measured) measured_.push_back(column.index);
    }
  }

  void read_rows() try {
    constexpr std::size_t kMostBadTimes = 100;
    std::size_t bad_times = 0;
    while (csv_.next()) {
      ++report_.rows;
      if (!time_) continue;
      for (const LogColumn& column : columns_)
        if (holds_numbers(column) && column.role != ColumnRole::left_out && column.role != ColumnRole::time)
          count_cell(column.index);
      TargetRows& rows = targets_[target_ ? std::string(csv_.word(*target_)) : std::string()];
      try {
        add_row(rows, time_->read(csv_));
      } catch (const InputError& error) {
        if (bad_times == 0) fault(error);
        if (++bad_times == kMostBadTimes) return;
      }
    }
  } catch (const InputError& error) {
    fault(error);
  }

  void count_cell(std::size_t index) {
    ColumnReport& column = report_.columns[index];
    double value = kNaN;
    if (!csv_.read_number(index, value)) {
      if (column.unreadable++ == 0)
        fault(csv_.error(index, "is " + as_shown(csv_.word(index)), "a number, or an empty cell"));
    } else if (std::isnan(value)) {
      ++column.missing;
    } else {
      column.least = std::fmin(column.least, value);
      column.greatest = std::fmax(column.greatest, value);
    }
  }

  void add_row(TargetRows& rows, double time_s) {
    report_.first_s = std::fmin(report_.first_s, time_s);
    report_.last_s = std::fmax(report_.last_s, time_s);
    std::vector<double> cells(measured_.size(), kNaN);
    for (std::size_t i = 0; i < cells.size(); ++i) csv_.read_number(measured_[i], cells[i]);
    const bool is_equal = !cells.empty() && cells == rows.cells;
    rows.equal = is_equal ? rows.equal + 1 : 1;
    if (rows.equal > longest_stuck_) {
      longest_stuck_ = rows.equal;
      stuck_line_ = csv_.line();
    }
    report_.repeated += is_equal && time_s == rows.time_s;
    report_.late += time_s < rows.time_s;
    if (time_s >= rows.time_s) {
      periods_s_.push_back(time_s - rows.time_s);
      if (!(periods_s_.back() <= report_.greatest_period_s)) {
        report_.greatest_period_s = periods_s_.back();
        report_.longest_gap_after_s = rows.time_s;
      }
    }
    if (!(time_s < rows.time_s)) rows.time_s = time_s;
    rows.cells = std::move(cells);
  }

  void summarise_times() {
    report_.targets = target_ ? targets_.size() : 0;
    if (periods_s_.empty()) {
      report_.median_period_s = report_.least_period_s = report_.greatest_period_s = kNaN;
      return;
    }
    constexpr double kGapPeriods = 3.0;
    const auto median = periods_s_.begin() + static_cast<std::ptrdiff_t>(periods_s_.size() / 2);
    std::nth_element(periods_s_.begin(), median, periods_s_.end());
    report_.median_period_s = *median;
    report_.least_period_s = *std::min_element(periods_s_.begin(), periods_s_.end());
    report_.gaps = static_cast<std::size_t>(std::count_if(periods_s_.begin(), periods_s_.end(), [&](double period_s) {
      return period_s > kGapPeriods * report_.median_period_s && report_.median_period_s > 0.0;
    }));
  }

  void odd(const std::string& what) { report_.oddities.push_back(what); }

  bool is_in_degrees(std::size_t index) const {
    return report_.columns[index].unit == "deg" || report_.columns[index].unit == "degrees";
  }

  // Of a position both angles would be.
  void look_for_radians() {
    double greatest = 0.0;
    std::string names, first;
    bool differ = false;
    for (const std::size_t index : measured_) {
      const ColumnReport& column = report_.columns[index];
      if (!is_in_degrees(index)) continue;
      if (first.empty()) first = std::string(apart(column.name).stem);
      names.append(names.empty() ? "" : ", ").append(column.name);
      greatest = std::fmax(greatest, std::fmax(std::abs(column.least), std::abs(column.greatest)));
      differ |= column.least < column.greatest;
    }
    if (differ && greatest <= 2.0 * kPi && report_.rows >= kFewestValues)
      odd(fmt::format("within 2 pi of 0: {}: are the angles radians, {}_rad?", names, first));
  }

  void look_at_values() {
    constexpr double kFirstYear_ms = 1e11, kLowFrequency_hz = 5.0;
    constexpr std::size_t kStuck = 10;
    if (time_ && time_->has_unit() && std::abs(report_.last_s) > kFirstYear_ms)
      odd(report_.columns[time_->index()].name + " is beyond the year 5000: are the times milliseconds, time_ms?");
    if (longest_stuck_ >= kStuck)
      odd(fmt::format("{} rows up to line {} measure the same: is the sensor stuck?", longest_stuck_, stuck_line_));
    look_for_radians();
    for (const std::size_t index : measured_) {
      const ColumnReport& column = report_.columns[index];
      const double greatest = std::fmax(std::abs(column.least), std::abs(column.greatest));
      const std::string stem(apart(column.name).stem);
      if (report_.rows < kFewestValues || std::isnan(greatest)) continue;
      if (stem == "bearing" && is_in_degrees(index) && greatest > 360.0)
        odd(fmt::format("{} goes beyond 360 degrees, to {:g}", column.name, greatest));
      if (column.unit == "hz" && column.greatest < kLowFrequency_hz)
        odd(fmt::format("{} is below {:g} Hz: are the frequencies kHz, {}_khz?", column.name, kLowFrequency_hz, stem));
    }
  }

  CsvReader csv_;
  const RecordingOptions& options_;
  LogReport report_;
  std::optional<TimeColumn> time_;
  std::vector<LogColumn> columns_;
  std::optional<std::size_t> target_;
  std::vector<std::size_t> measured_;
  std::unordered_map<std::string, TargetRows> targets_;
  std::vector<double> periods_s_;
  std::size_t longest_stuck_ = 0, stuck_line_ = 0;
};

// As the trackers' reader reads it: what it refuses is a fault, what it passes over is odd.
void read_as_trackers_do(CsvReader csv, const RecordingOptions& options, LogReport& report) try {
  if (is_geographic_track(csv)) {
    const GeographicTracks tracks = read_geographic_tracks(std::move(csv), {}, options);
    if (tracks.not_available > 0)
      report.oddities.push_back(fmt::format("{} values say \"not available\"", tracks.not_available));
    if (tracks.null_island > 0) report.oddities.push_back(fmt::format("{} positions at 0, 0", tracks.null_island));
    return;
  }
  MeasurementLog log(std::move(csv), options);
  std::size_t rows = 0;
  while (log.next()) ++rows;
  if (static_cast<std::size_t>(log.counts().missing) == rows)
    throw InputError(report.log, fmt::format("has no usable measurement in its {} row{}", rows, rows == 1 ? "" : "s"),
                     "at least one");
  LogFindings findings = log.findings();
  findings.left_out.clear();
  if (const std::string note = findings.note(); !note.empty()) report.oddities.push_back(note);
} catch (const InputError& error) {
  const std::string what = error.what();
  const auto says_where = [&](const std::string& fault) { return fault.starts_with(error.where()); };
  if (std::none_of(report.faults.begin(), report.faults.end(), says_where)) report.faults.push_back(what);
}

}  // namespace

LogReport check_log(const std::filesystem::path& path, const RecordingOptions& options) {
  LogReport report = LogSurvey(open_table(path, options), options).report();
  std::error_code unknown;
  if (std::filesystem::is_regular_file(path, unknown)) read_as_trackers_do(open_table(path, options), options, report);
  if (report.rows == 0 && report.faults.empty()) report.faults.push_back(report.log + ": has no rows");
  return report;
}

}  // namespace truebearing
