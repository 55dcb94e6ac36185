// SPDX-License-Identifier: Apache-2.0
#include "truebearing/recording/recording_csv.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <system_error>
#include <utility>

#include "truebearing/core/angle.hpp"
#include "truebearing/core/constants.hpp"
#include "truebearing/core/error.hpp"
#include "truebearing/core/printable.hpp"
#include "truebearing/recording/log_units.hpp"
#include "truebearing/recording/velocity_truth.hpp"

namespace truebearing {
namespace {

bool identical(const std::vector<double>& a, const std::vector<double>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); });
}

}  // namespace

MeasurementLog::MeasurementLog(CsvReader csv, RecordingOptions options)
    : csv_(std::move(csv)),
      options_(std::move(options)),
      time_(csv_),
      layout_(read_log_layout(csv_, time_, options_)),
      cell_of_(csv_.header().size()),
      target_(options_.target) {
  columns_and_counts_.measured = layout_.measured();
  columns_and_counts_.sources = options_.sources;
  const auto is_latitude = [](const std::string& name) { return apart(name).stem == "latitude"; };
  if (std::any_of(measured().begin(), measured().end(), is_latitude))
    throw InputError(csv_.name(), "holds positions on the globe, which are no measurements",
                     "`truebearing compare STUDY.toml --truth`, which measures them");
  if (!layout_.faults.empty()) throw layout_.faults.front();
  if (!options_.target.empty() && !layout_.target)
    throw InputError(csv_.name(), "has no column that tells targets apart",
                     "vessel, flight, track, mmsi, icao24, callsign");
  if (!(options_.sort_window_s >= 0.0)) throw InputError("sort window", "is negative or no number", "seconds >= 0");
  for (const LogColumn& column : layout_.columns) {
    const bool is_number = column.role != ColumnRole::left_out && column.role != ColumnRole::time &&
                           column.role != ColumnRole::target && column.role != ColumnRole::source;
    if (!is_number) continue;
    cell_of_[column.index] = columns_.size();
    columns_.push_back(column.index);
  }
  findings_.left_out = layout_.left_out(csv_);
  if (!options_.sources.empty()) find_sources();
  // Rows that are in order by clocks that disagree are so far out of it by one that is right.
  if (const auto [least, most] = std::minmax_element(options_.clock_offsets_s.begin(), options_.clock_offsets_s.end());
      least != most && options_.late_keep_s == 0.0)
    options_.sort_window_s += *most - *least;
}

// Where each sensor's components stand among all that is measured; nowhere for one that the log has no columns of.
void MeasurementLog::find_sources() {
  const std::vector<std::string>& all = measured();
  std::vector<std::string> known;
  for (const Source& source : options_.sources) {
    std::vector<Eigen::Index> places;
    for (const std::string& component : source.components)
      if (const auto at = std::find(all.begin(), all.end(), component); at != all.end())
        places.push_back(at - all.begin());
    if (places.size() != source.components.size()) places.clear();
    if (!places.empty()) {
      known.push_back(source.name);
      if (const auto same = std::find(places_of_.begin(), places_of_.end(), places);
          same != places_of_.end() && !layout_.source)
        throw InputError(
            csv_.name(),
            fmt::format("does not tell {} and {} apart, which measure the same",
                        options_.sources[static_cast<std::size_t>(same - places_of_.begin())].name, source.name),
            "a column `sensor` with their names");
    }
    places_of_.push_back(std::move(places));
  }
  if (known.empty()) {
    std::vector<std::string> wanted;
    for (const Source& source : options_.sources)
      wanted.push_back(fmt::format("{} of {}", fmt::join(source.components, ", "), source.name));
    throw InputError(csv_.name(), fmt::format("measures {}", fmt::join(all, ", ")),
                     fmt::format("{}", fmt::join(wanted, "; ")));
  }
}

// By its name, else the one whose components are those that the row fills. A row that fills nothing is of the first, and
// missing.
std::size_t MeasurementLog::source_of_row(const Measurement& measurement) const {
  if (layout_.source) {
    const std::string name(csv_.text(*layout_.source));
    std::vector<std::string> names;  // of those whose columns the log has
    for (std::size_t i = 0; i < options_.sources.size(); ++i) {
      if (places_of_[i].empty()) continue;
      if (options_.sources[i].name == name) return i;
      names.push_back(options_.sources[i].name);
    }
    throw csv_.error(*layout_.source, "is " + as_shown(name), fmt::format("one of {}", fmt::join(names, ", ")));
  }
  const auto filled = measurement.z.array().isFinite().count();
  if (filled == 0) return 0;
  std::optional<std::size_t> best;  // the one that the row fills most of, with nothing left over
  Eigen::Index most = 0;
  for (std::size_t i = 0; i < places_of_.size(); ++i) {
    Eigen::Index own = 0;
    for (const Eigen::Index place : places_of_[i]) own += std::isfinite(measurement.z[place]) ? 1 : 0;
    const bool fits_better = own == filled && (!best || (places_of_[i].size() < places_of_[*best].size()));
    if (!fits_better) continue;
    best = i;
    most = own;
  }
  if (!best || most == 0)
    throw csv_.error(layout_.z.front().index, "stands beside what another sensor measures", "a row for each sensor");
  return *best;
}

// Of all that is measured what the row's own sensor does.
void MeasurementLog::keep_own(Measurement& measurement) const {
  const std::size_t source = source_of_row(measurement);
  const std::vector<Eigen::Index>& places = places_of_[source];
  measurement.source = static_cast<int>(source);
  const BoundedVector z = measurement.z, sigma = measurement.sigma;
  measurement.z = BoundedVector::Constant(static_cast<Eigen::Index>(options_.sources[source].components.size()), kNaN);
  if (sigma.size() > 0) measurement.sigma = measurement.z;
  for (std::size_t i = 0; i < places.size(); ++i) {
    measurement.z[static_cast<Eigen::Index>(i)] = z[places[i]];
    if (sigma.size() > 0) measurement.sigma[static_cast<Eigen::Index>(i)] = sigma[places[i]];
  }
  if (!measurement.sigma.allFinite()) measurement.sigma.resize(0);  // the sensor's own then
}

// Rows without a name are of the target that is read, unless a certain one is wanted.
bool MeasurementLog::is_of_target() {
  if (!layout_.target) return true;
  const std::string target = read_target_name(csv_, *layout_.target);
  if (target.empty() && options_.target.empty()) return true;
  if (target_.empty()) target_ = target;
  if (target == target_) return true;
  if (options_.target.empty())
    throw csv_.error(*layout_.target, fmt::format("is {}, after rows of {}", as_shown(target), as_shown(target_)),
                     fmt::format("one target, chosen by --track-id {}", printable(target_)));
  ++findings_.of_others;
  return false;
}

void MeasurementLog::check_lateness(double time_s) {
  if (rows_ == 0) {
    first_time_s_ = latest_time_s_ = time_s;
    return;
  }
  times_differ_ |= time_s != first_time_s_;
  if (time_s >= latest_time_s_) {
    latest_time_s_ = time_s;
    return;
  }
  if (options_.late_keep_s > 0.0) return;  // whoever puts it in order counts it
  if (time_s < latest_time_s_ - options_.sort_window_s) {
    const InputError late =
        csv_.error(time_.index(), fmt::format("is {}, earlier than {} in a row before", time_s, latest_time_s_));
    throw InputError(
        late.where(), late.found(),
        fmt::format("times that do not decrease, or --sort-window {0:.9g} or more, or --late {0:.9g} of `track`",
                    greatest_lateness(time_s)));
  }
  ++findings_.late;
}

// Of this row and those after it, which are read for that where they are a file's: what a smaller window would refuse next.
double MeasurementLog::greatest_lateness(double time_s) {
  double late_s = latest_time_s_ - time_s;
  std::error_code unknown;
  if (!std::filesystem::is_regular_file(csv_.name(), unknown)) return late_s;
  try {
    while (csv_.next()) {
      if (!is_of_target()) continue;
      const double next_s = time_.read(csv_);
      latest_time_s_ = std::max(latest_time_s_, next_s);
      late_s = std::max(late_s, latest_time_s_ - next_s);
    }
  } catch (const InputError&) {  // which is said when it is its turn
  }
  return late_s;
}

Measurement MeasurementLog::read_measurement(const std::vector<double>& cells, double time_s) {
  const auto number = [&](const LogColumn& column) { return cells[cell_of_[column.index]] * column.factor; };
  Measurement measurement;
  measurement.time_s = time_s;
  measurement.z.resize(static_cast<Eigen::Index>(layout_.z.size()));
  measurement.sigma.resize(static_cast<Eigen::Index>(layout_.sigma.size()));
  for (std::size_t i = 0; i < layout_.z.size(); ++i) measurement.z(static_cast<Eigen::Index>(i)) = number(layout_.z[i]);
  remove_impossible(measurement);
  look_at_place(measurement);
  for (std::size_t i = 0; i < layout_.sigma.size(); ++i) {
    const double sigma = number(layout_.sigma[i]);
    if (sigma <= 0.0)
      throw csv_.error(layout_.sigma[i].index, "is " + as_shown(csv_.word(layout_.sigma[i].index)), "a number > 0");
    measurement.sigma(static_cast<Eigen::Index>(i)) = sigma;
    // A measurement of unknown or infinite spread says nothing.
    if (std::isnan(sigma) && options_.sources.empty()) measurement.z(static_cast<Eigen::Index>(i)) = kNaN;
  }
  if (!options_.sources.empty()) keep_own(measurement);
  // A row without a guess has empty cells there.
  if (!layout_.guess.empty() && !std::isnan(number(layout_.guess[0]))) {
    for (const LogColumn& column : layout_.guess)
      if (!(number(column) > 0.0))
        throw csv_.error(column.index, "is " + as_shown(csv_.word(column.index)), "a number > 0");
    measurement.guess = TargetGuess{number(layout_.guess[0]), number(layout_.guess[1])};
    if (layout_.guess.size() == 4) {
      measurement.guess->speed_mps = number(layout_.guess[2]);
      measurement.guess->speed_sigma_mps = number(layout_.guess[3]);
    }
  }
  if (layout_.sensor.empty()) return measurement;

  SensorState sensor;
  sensor.position_m << number(layout_.sensor[0]), number(layout_.sensor[1]);
  if (layout_.sensor.size() == 4) sensor.velocity_mps << number(layout_.sensor[2]), number(layout_.sensor[3]);
  // A height that the log does not tell is the site's (SpaceSite); one that this row does not is missed by who looks up.
  sensor.up_m = layout_.sensor_up ? number(*layout_.sensor_up) : kNaN;
  if (layout_.sensor_climb) sensor.climb_mps = number(*layout_.sensor_climb);
  const std::vector<std::string>& components = components_of(columns_and_counts_, measurement);
  const bool looks_up = std::find(components.begin(), components.end(), "elevation_deg") != components.end();
  const bool has_height = !layout_.sensor_up || (std::isfinite(sensor.up_m) && std::isfinite(sensor.climb_mps));
  if (sensor.position_m.allFinite() && sensor.velocity_mps.allFinite() && (has_height || !looks_up))
    measurement.sensor = sensor;
  else
    measurement.z.setConstant(kNaN);  // a measurement from an unknown place says nothing either
  return measurement;
}

// The file's next row of the target to those that wait; false at the end.
bool MeasurementLog::read_row() {
  do
    if (!csv_.next()) return false;
  while (!is_of_target());
  Row row;
  row.time_s = time_.read(csv_);
  row.line = csv_.line();
  for (const std::size_t column : columns_) row.cells.push_back(csv_.number(column));
  row.measurement = read_measurement(row.cells, row.time_s);
  // A row that fills nothing and names no sensor is nobody's.
  if (!options_.clock_offsets_s.empty() && (layout_.source || !row.measurement.z.array().isNaN().all()))
    row.time_s = row.measurement.time_s -= options_.clock_offsets_s[static_cast<std::size_t>(row.measurement.source)];
  check_lateness(row.time_s);
  row.number = rows_++;
  row.truth = BoundedVector::Constant(static_cast<Eigen::Index>(layout_.truth.size()), kNaN);
  for (std::size_t i = 0; i < layout_.truth.size(); ++i)
    if (const auto& column = layout_.truth[i])
      row.truth(static_cast<Eigen::Index>(i)) = row.cells[cell_of_[column->index]] * column->factor;
  waiting_.push(std::move(row));
  return true;
}

bool MeasurementLog::next() {
  while (true) {
    const auto is_due = [&] {
      return !waiting_.empty() && waiting_.top().time_s <= latest_time_s_ - options_.sort_window_s;
    };
    bool more = true;
    while (more && !is_due()) more = read_row();
    if (waiting_.empty()) {
      check_end();
      return false;
    }
    Row row = waiting_.top();
    waiting_.pop();
    const bool is_repeated = given_ > 0 && row.time_s == row_.time_s &&
                             row.measurement.source == row_.measurement.source && identical(row.cells, row_.cells);
    if (is_repeated) {
      ++columns_and_counts_.counts.repeated;
      continue;
    }
    row_ = std::move(row);
    ++given_;
    columns_and_counts_.counts.missing += is_unusable(columns_and_counts_, row_.measurement);
    return true;
  }
}

// All rows at one time are an epoch written with too few digits, as a rule; two may be of two sensors.
void MeasurementLog::check_end() const {
  constexpr std::uint64_t kMost = 2;
  if (given_ == 0)
    throw InputError(csv_.name(), "has no rows" + (options_.target.empty() ? "" : " of " + as_shown(options_.target)),
                     "at least one measurement");
  if (given_ > kMost && !times_differ_)
    throw InputError(csv_.name(), fmt::format("has all its {} rows at one time, {}", given_, first_time_s_),
                     "times with all their digits");
}

void MeasurementLog::append_to(Recording& recording) const {
  recording.measurements.push_back(measurement());
  recording.line.push_back(row_.line);
  if (!truth_space()) return;
  recording.truth.resize(1);
  recording.truth[0].x.push_back(truth());
}

void MeasurementLog::complete(Recording& recording) const {
  recording.measured = measured();
  recording.sources = options_.sources;
  recording.truth_space = truth_space();
  recording.counts = counts();
  if (!truth_space()) return;
  std::vector<double> time_s;
  for (const Measurement& measurement : recording.measurements) time_s.push_back(measurement.time_s);
  std::vector<bool> given;
  for (const auto& column : layout_.truth) given.push_back(column.has_value());
  complete_velocities(*truth_space(), given, time_s, recording.truth[0].x);
}

Recording read_recording(CsvReader csv, const RecordingOptions& options, LogFindings* findings) {
  RecordingOptions sorted = options;
  sorted.sort_window_s = std::max(options.sort_window_s, options.late_keep_s);
  sorted.late_keep_s = 0.0;
  MeasurementLog log(std::move(csv), sorted);
  Recording recording;
  while (log.next()) log.append_to(recording);
  log.complete(recording);
  if (findings) *findings = log.findings();
  return recording;
}

Recording read_recording(const std::filesystem::path& path, const RecordingOptions& options, LogFindings* findings) {
  return read_recording(open_table(path, options), options, findings);
}

Recording read_recording(std::istream& stream, const std::string& name, const RecordingOptions& options,
                         LogFindings* findings) {
  return read_recording(with_names(CsvReader(stream, name), options), options, findings);
}

}  // namespace truebearing
