// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tracker/step_log.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <iterator>
#include <limits>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>

#include "truebearing/core/covariance.hpp"
#include "truebearing/core/error.hpp"
#include "truebearing/recording/debrief_replay.hpp"

namespace truebearing {
namespace {

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

// Columns name_1, name_2, ... as far as they go.
std::vector<int> vector_columns(const CsvReader& csv, const std::string& name) {
  std::vector<int> columns;
  while (true) {
    const int column = csv.column(fmt::format("{}_{}", name, columns.size() + 1));
    if (column < 0) return columns;
    columns.push_back(column);
  }
}

// Columns <prefix><component>, and the names of the components.
std::vector<int> component_columns(const CsvReader& csv, const std::string& prefix,
                                   std::vector<std::string>& components) {
  std::vector<int> columns;
  for (std::size_t column = 0; column < csv.header().size(); ++column)
    if (csv.header()[column].starts_with(prefix)) {
      components.push_back(csv.header()[column].substr(prefix.size()));
      columns.push_back(static_cast<int>(column));
    }
  return columns;
}

// The upper triangle name_1_1, name_1_2, ..., row by row; empty where it is not all there.
std::vector<int> triangle_columns(const CsvReader& csv, const std::string& name, std::size_t size) {
  std::vector<int> columns;
  for (std::size_t i = 1; i <= size; ++i)
    for (std::size_t j = i; j <= size; ++j) {
      const int column = csv.column(fmt::format("{}_{}_{}", name, i, j));
      if (column < 0) return {};
      columns.push_back(column);
    }
  return columns;
}

BoundedVector read_vector(const CsvReader& csv, const std::vector<int>& columns) {
  BoundedVector v(static_cast<Eigen::Index>(columns.size()));
  for (std::size_t i = 0; i < columns.size(); ++i)
    v[static_cast<Eigen::Index>(i)] = csv.number(static_cast<std::size_t>(columns[i]));
  return v;
}

BoundedMatrix read_triangle(const CsvReader& csv, const std::vector<int>& columns, Eigen::Index size) {
  BoundedMatrix A(size, size);
  std::size_t next = 0;
  for (Eigen::Index i = 0; i < size; ++i)
    for (Eigen::Index j = i; j < size; ++j) A(i, j) = A(j, i) = csv.number(static_cast<std::size_t>(columns[next++]));
  return A;
}

// To what is there: of sensors that measure less than others the last cells are empty.
void shorten(Innovation& innovation) {
  Eigen::Index size = innovation.nu.size();
  while (size > 1 && std::isnan(innovation.nu[size - 1]) && std::isnan(innovation.S(size - 1, size - 1))) --size;
  innovation.z.conservativeResize(size);
  innovation.nu.conservativeResize(size);
  innovation.S.conservativeResize(size, size);
}

// By the place of its sensor's name among all of them.
void number_sources(const std::vector<std::string>& sensors, std::vector<StepRecord>& records) {
  const std::set<std::string> names(sensors.begin(), sensors.end());
  for (std::size_t k = 0; k < sensors.size(); ++k)
    records[k].source = static_cast<int>(std::distance(names.begin(), names.find(sensors[k])));
}

StepStatus read_status(const CsvReader& csv, int column) {
  if (column < 0) return StepStatus::ok;
  const std::string_view text = csv.text(static_cast<std::size_t>(column));
  for (const StepStatus status :
       {StepStatus::ok, StepStatus::rejected, StepStatus::coasted, StepStatus::unobservable, StepStatus::failed})
    if (text == to_string(status)) return status;
  throw csv.error(static_cast<std::size_t>(column), fmt::format("\"{}\" is no status", text),
                  "ok, rejected, coasted, unobservable, failed");
}

std::vector<std::string> log_header(const StateSpace& space, const StepLogWriter::Columns& columns) {
  const int measurements = columns.measurements;
  std::vector<std::string> header{"time_s", "tracker", "track", "status"};
  if (!columns.sensors.empty()) header.emplace_back("sensor");
  if (columns.revised) header.emplace_back("revised");
  for (const std::string& component : space.components) header.push_back("x_" + component);
  const auto add_triangle = [&](const char* name, int size) {
    for (int i = 1; i <= size; ++i)
      for (int j = i; j <= size; ++j) header.push_back(fmt::format("{}_{}_{}", name, i, j));
  };
  add_triangle("P", space.size());
  for (int i = 1; i <= measurements; ++i) header.push_back(fmt::format("z_{}", i));
  for (int i = 1; i <= measurements; ++i) header.push_back(fmt::format("nu_{}", i));
  add_triangle("S", measurements);
  return header;
}

// Forgets the rows that one at time_s stands in place of: those after it, and where it is revised those of its time. A
// late row is followed by all that come after it once more.
void take_back(double time_s, bool revised, StepLog& log, std::vector<std::string>& sensors) {
  const auto end = log.records.end();
  const auto first = revised ? std::lower_bound(log.records.begin(), end, time_s,
                                                [](const StepRecord& record, double t) { return record.time_s < t; })
                             : std::upper_bound(log.records.begin(), end, time_s,
                                                [](double t, const StepRecord& record) { return t < record.time_s; });
  const auto kept = static_cast<std::size_t>(first - log.records.begin());
  log.records.erase(first, end);
  log.z.resize(kept);
  log.truth.resize(kept);
  sensors.resize(std::min(sensors.size(), kept));
}

StepLog read_rows(CsvReader& csv, const std::string& tracker) {
  const std::size_t time = csv.required_column("time_s");
  const std::size_t track = csv.required_column("track");
  const int tracker_column = csv.column("tracker");
  if (!tracker.empty() && tracker_column < 0)
    throw InputError(csv.name(), "has no column `tracker` to find \"" + tracker + "\" in");
  std::vector<std::string> components;
  const std::vector<int> x_columns = component_columns(csv, "x_", components);
  if (components.empty()) throw InputError(csv.name(), "has no column x_<component>", "x_position_m and the like");
  StepLog log;
  log.space = &state_space_of_components(components);
  const std::vector<int> truth_columns = component_columns(csv, "truth_", log.truth_components);
  const std::size_t n = components.size();
  const std::vector<int> P_columns = triangle_columns(csv, "P", n);
  if (P_columns.empty())
    throw InputError(csv.name(), "lacks columns of P", fmt::format("P_1_1 to P_{0}_{0}, upper triangle", n));
  const std::vector<int> z_columns = vector_columns(csv, "z");
  const std::vector<int> nu_columns = vector_columns(csv, "nu");
  const std::vector<int> S_columns = triangle_columns(csv, "S", nu_columns.size());
  const int status_column = csv.column("status"), sensor_column = csv.column("sensor"),
            revised_column = csv.column("revised");
  std::vector<std::string> sensors;  // of each record
  log.has_innovation = !nu_columns.empty() && z_columns.size() == nu_columns.size() && !S_columns.empty();
  if (z_columns.size() > kMaxDimension)
    throw InputError(csv.name(), fmt::format("has {} columns z", z_columns.size()),
                     fmt::format("at most {}", kMaxDimension));

  if (truth_columns.size() > kMaxDimension)
    throw InputError(csv.name(), fmt::format("has {} columns truth_", truth_columns.size()),
                     fmt::format("at most {}", kMaxDimension));

  double last_time_s = -std::numeric_limits<double>::infinity();
  bool was_revised = false;
  while (csv.next()) {
    if (!tracker.empty() && csv.text(static_cast<std::size_t>(tracker_column)) != tracker) continue;
    StepRecord record;
    record.space = log.space;
    record.time_s = csv.number(time);
    if (revised_column >= 0) {
      const bool revised = csv.number(static_cast<std::size_t>(revised_column)) == 1.0;
      if (record.time_s < last_time_s || (revised && !was_revised)) {
        take_back(record.time_s, revised, log, sensors);
        last_time_s = record.time_s;
      }
      was_revised = revised;
    }
    if (!(record.time_s >= last_time_s))
      throw csv.error(time, fmt::format("{} after {}", record.time_s, last_time_s), "times that do not decrease");
    last_time_s = record.time_s;
    const double track_number = csv.number(track);
    if (!(track_number >= 0.0 && track_number < 1e9) || track_number != std::floor(track_number))
      throw csv.error(track, "is no track number", "an integer >= 0");
    record.track = static_cast<int>(track_number);
    record.status = read_status(csv, status_column);
    record.x = read_vector(csv, x_columns);
    record.P = read_triangle(csv, P_columns, static_cast<Eigen::Index>(n));
    if (!record.x.allFinite())
      throw csv.error(static_cast<std::size_t>(x_columns[0]), "the state is not finite", "numbers");
    if (!is_covariance(record.P))
      throw csv.error(static_cast<std::size_t>(P_columns[0]), "P is not symmetric positive semi-definite",
                      "a covariance");
    if (log.has_innovation) {
      Innovation innovation{read_vector(csv, z_columns), read_vector(csv, nu_columns),
                            read_triangle(csv, S_columns, static_cast<Eigen::Index>(nu_columns.size())), 0.0};
      shorten(innovation);
      innovation.nis = mahalanobis_squared(innovation.S, innovation.nu);
      if (std::isfinite(innovation.nis)) record.innovation = innovation;
    }
    if (sensor_column >= 0) sensors.emplace_back(csv.text(static_cast<std::size_t>(sensor_column)));
    log.records.push_back(record);
    log.z.push_back(record.innovation ? record.innovation->z : read_vector(csv, z_columns));
    log.truth.push_back(read_vector(csv, truth_columns));
  }
  if (log.records.empty())
    throw InputError(csv.name(), tracker.empty() ? "has no rows" : "has no rows of the tracker \"" + tracker + "\"");
  number_sources(sensors, log.records);
  return log;
}

}  // namespace

StepLog read_step_log(const std::filesystem::path& path, const std::string& tracker) {
  CsvReader csv(path);
  return read_rows(csv, tracker);
}

StepLog read_step_log(std::istream& stream, const std::string& name, const std::string& tracker) {
  CsvReader csv(stream, name);
  return read_rows(csv, tracker);
}

bool is_step_log(const std::filesystem::path& path) {
  std::error_code unknown;
  if (!std::filesystem::is_regular_file(path, unknown) || is_debrief_replay(path)) return false;
  const CsvReader csv(path);
  std::vector<std::string> components;
  component_columns(csv, "x_", components);
  return csv.column("track") >= 0 && csv.column("P_1_1") >= 0 && !components.empty();
}

std::vector<std::string> trackers_in_step_log(const std::filesystem::path& path) {
  CsvReader csv(path);
  std::vector<std::string> trackers;
  const int column = csv.column("tracker");
  while (column >= 0 && csv.next()) {
    const std::string_view name = csv.text(static_cast<std::size_t>(column));
    if (std::find(trackers.begin(), trackers.end(), name) == trackers.end()) trackers.emplace_back(name);
  }
  return trackers;
}

StepLogWriter::StepLogWriter(const StateSpace& space, Columns columns)
    : states_(space.size()), columns_(std::move(columns)), csv_(log_header(space, columns_)), header_(csv_.take()) {}

void StepLogWriter::add(const std::string& tracker, const StepRecord& record, bool revised) {
  const int measurements = columns_.measurements;
  csv_.number(record.time_s);
  csv_.text(tracker);
  csv_.number(record.track);
  csv_.text(to_string(record.status));
  if (!columns_.sensors.empty()) csv_.text(columns_.sensors[static_cast<std::size_t>(record.source)]);
  if (columns_.revised) csv_.number(revised ? 1 : 0);
  for (int i = 0; i < states_; ++i) csv_.number(record.x[i]);
  for (int i = 0; i < states_; ++i)
    for (int j = i; j < states_; ++j) csv_.number(record.P(i, j));
  const int told = record.innovation ? static_cast<int>(record.innovation->nu.size()) : 0;
  const bool has_z = told > 0 && record.innovation->z.size() == told;
  for (int i = 0; i < measurements; ++i) csv_.number(has_z && i < told ? record.innovation->z[i] : kMissing);
  for (int i = 0; i < measurements; ++i) csv_.number(i < told ? record.innovation->nu[i] : kMissing);
  for (int i = 0; i < measurements; ++i)
    for (int j = i; j < measurements; ++j) csv_.number(j < told ? record.innovation->S(i, j) : kMissing);
  csv_.end_row();
  rows_.push_back({record.time_s, csv_.take()});
}

void StepLogWriter::sort_by_time() {
  std::stable_sort(rows_.begin(), rows_.end(), [](const Row& a, const Row& b) { return a.time_s < b.time_s; });
}

std::string StepLogWriter::str() const {
  std::string text = header_;
  for (const Row& row : rows_) text += row.text;
  return text;
}

std::string StepLogWriter::take() {
  std::string text = str();
  header_.clear();
  rows_.clear();
  return text;
}

}  // namespace truebearing
