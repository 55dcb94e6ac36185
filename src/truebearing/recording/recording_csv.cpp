#include "truebearing/recording/recording_csv.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <string_view>

#include "truebearing/core/angle.hpp"
#include "truebearing/core/constants.hpp"
#include "truebearing/core/error.hpp"
#include "truebearing/io/csv.hpp"
#include "truebearing/recording/velocity_truth.hpp"

namespace truebearing {

/// Which column of a log means what.
struct CsvLayout {
  /// A column of the log and what its numbers are multiplied by.
  struct Column {
    std::size_t index;
    double factor;
  };
  std::size_t time = 0;
  std::vector<std::string> measured;
  std::vector<Column> z;
  std::vector<Column> sigma;        // as long as z, or empty
  std::vector<std::size_t> sensor;  // none, position, or position and velocity
  std::vector<std::size_t> guess;   // none, range, or range and speed, with their sigmas
  const StateSpace* truth_space = nullptr;
  std::vector<std::optional<Column>> truth;  // by component of the truth space
};

namespace {

using Column = CsvLayout::Column;

constexpr double kRadiansPerDegree = radians(1.0);

/// Multiplies a number of a log to make it one of the program.
struct Unit {
  std::string_view suffix;
  double factor;
};
constexpr std::array kUnits{Unit{"_m", 1.0},     Unit{"_mps", 1.0},
                            Unit{"_mps2", 1.0},  Unit{"_rad", 1.0},
                            Unit{"_hz", 1.0},    Unit{"_deg", kRadiansPerDegree},
                            Unit{"_radps", 1.0}, Unit{"_degps", kRadiansPerDegree}};

constexpr std::array<const char*, 4> kSensorColumns{"sensor_east_m", "sensor_north_m", "sensor_east_mps",
                                                    "sensor_north_mps"};
constexpr std::array<const char*, 4> kGuessColumns{"guess_range_m", "guess_range_sigma_m", "guess_speed_mps",
                                                   "guess_speed_sigma_mps"};
constexpr std::string_view kTruthPrefix = "truth_";
constexpr std::string_view kSigma = "_sigma_";

const Unit* find_unit(std::string_view column) {
  const auto found = std::find_if(kUnits.begin(), kUnits.end(), [&](const Unit& unit) {
    return column.size() > unit.suffix.size() && column.ends_with(unit.suffix);
  });
  return found == kUnits.end() ? nullptr : &*found;
}

std::string valid_units() {
  std::string line = "a name that ends in ";
  for (const Unit& unit : kUnits) line += (&unit == kUnits.data() ? "" : ", ") + std::string(unit.suffix);
  return line;
}

/// "position_m" -> "position_sigma_m".
std::string sigma_column(const std::string& measured) {
  const std::size_t split = measured.size() - find_unit(measured)->suffix.size();
  return measured.substr(0, split) + "_sigma" + measured.substr(split);
}

std::size_t position_in(const std::vector<std::string>& names, std::string_view name) {
  return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
}

Column unit_column(const CsvReader& csv, std::size_t index) {
  const Unit* unit = find_unit(csv.header()[index]);
  if (!unit) throw InputError(csv.name() + ": " + csv.header()[index], "names no known unit", valid_units());
  return {index, unit->factor};
}

// Of four names those that the log has: none, the first two or all.
std::vector<std::size_t> columns_of(const CsvReader& csv, const std::array<const char*, 4>& names, const char* what) {
  std::vector<std::size_t> columns;
  for (const char* name : names)
    if (const int index = csv.column(name); index >= 0) columns.push_back(static_cast<std::size_t>(index));
  const bool first_two = csv.column(names[0]) >= 0 && csv.column(names[1]) >= 0;
  if (!columns.empty() && (!first_two || columns.size() % 2 != 0))
    throw InputError(csv.name(), fmt::format("has {} columns that do not belong together", what),
                     fmt::format("{}, {}, and {}, {} with them", names[0], names[1], names[2], names[3]));
  return columns;
}

void find_truth(const CsvReader& csv, const std::vector<std::size_t>& columns, CsvLayout& layout) {
  if (columns.empty()) return;
  std::vector<std::string> given;
  for (const std::size_t index : columns) given.push_back(csv.header()[index].substr(kTruthPrefix.size()));
  // The smallest that has them all; a frequency alone says nothing of the plane.
  const std::vector<std::string> kFrequencyAlone{"frequency_hz"};
  for (const StateSpace* space : {&line_space(), &plane_space(), &plane_frequency_space()}) {
    const auto known = [&](const std::string& component) { return space->component_index(component) >= 0; };
    if (!layout.truth_space && given != kFrequencyAlone && std::all_of(given.begin(), given.end(), known))
      layout.truth_space = space;
  }
  if (!layout.truth_space) layout.truth_space = &state_space_of_components(given);
  for (const std::string& component : layout.truth_space->components) {
    const std::size_t i = position_in(given, component);
    layout.truth.push_back(i < given.size() ? std::optional(unit_column(csv, columns[i])) : std::nullopt);
  }
}

CsvLayout read_csv_layout(const CsvReader& csv) {
  CsvLayout layout;
  layout.time = csv.required_column("time_s");
  layout.sensor = columns_of(csv, kSensorColumns, "own-ship");
  layout.guess = columns_of(csv, kGuessColumns, "guess");
  std::vector<std::size_t> truth;
  std::vector<std::string> sigma_names;
  for (std::size_t index = 0; index < csv.header().size(); ++index) {
    const std::string& name = csv.header()[index];
    const bool sensor = std::find(kSensorColumns.begin(), kSensorColumns.end(), name) != kSensorColumns.end();
    const bool guess = std::find(kGuessColumns.begin(), kGuessColumns.end(), name) != kGuessColumns.end();
    if (index == layout.time || sensor || guess) continue;
    const Column column = unit_column(csv, index);
    if (name.starts_with(kTruthPrefix)) {
      truth.push_back(index);
    } else if (name.find(kSigma) != std::string::npos) {
      sigma_names.push_back(name);
    } else {
      layout.measured.push_back(name);
      layout.z.push_back(column);
    }
  }
  if (layout.z.empty() || layout.z.size() > kMaxDimension)
    throw InputError(csv.name(), fmt::format("has {} measured columns", layout.z.size()),
                     fmt::format("1 to {}, besides time_s, sensor_, sigma and truth_ columns", kMaxDimension));

  std::vector<std::string> expected;
  for (const std::string& name : layout.measured) expected.push_back(sigma_column(name));
  for (const std::string& name : sigma_names)
    if (position_in(expected, name) == expected.size())
      throw InputError(csv.name() + ": " + name, "belongs to no measured column",
                       fmt::format("{}", fmt::join(expected, ", ")));
  if (!sigma_names.empty())
    for (const std::string& name : expected) layout.sigma.push_back(unit_column(csv, csv.required_column(name)));
  find_truth(csv, truth, layout);
  return layout;
}

std::vector<double> read_numbers(const CsvReader& csv) {
  std::vector<double> row(csv.header().size());
  for (std::size_t i = 0; i < row.size(); ++i) row[i] = csv.number(i);
  return row;
}

bool identical(const std::vector<double>& a, const std::vector<double>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); });
}

// A row without a guess has empty cells there.
std::optional<TargetGuess> read_guess(const CsvReader& csv, const CsvLayout& layout, const std::vector<double>& row) {
  if (layout.guess.empty() || std::isnan(row[layout.guess[0]])) return std::nullopt;
  for (const std::size_t index : layout.guess)
    if (!(row[index] > 0.0)) throw csv.error(index, fmt::format("is {}", row[index]), "a number > 0");
  TargetGuess guess{row[layout.guess[0]], row[layout.guess[1]]};
  if (layout.guess.size() == 4) {
    guess.speed_mps = row[layout.guess[2]];
    guess.speed_sigma_mps = row[layout.guess[3]];
  }
  return guess;
}

Measurement read_measurement(const CsvReader& csv, const CsvLayout& layout, const std::vector<double>& row) {
  Measurement measurement;
  measurement.time_s = row[layout.time];
  measurement.z.resize(static_cast<Eigen::Index>(layout.z.size()));
  measurement.sigma.resize(static_cast<Eigen::Index>(layout.sigma.size()));
  for (std::size_t i = 0; i < layout.z.size(); ++i)
    measurement.z(static_cast<Eigen::Index>(i)) = row[layout.z[i].index] * layout.z[i].factor;
  for (std::size_t i = 0; i < layout.sigma.size(); ++i) {
    const double sigma = row[layout.sigma[i].index];
    if (sigma <= 0.0) throw csv.error(layout.sigma[i].index, fmt::format("is {}", sigma), "a number > 0");
    measurement.sigma(static_cast<Eigen::Index>(i)) = sigma * layout.sigma[i].factor;
    // A measurement of unknown or infinite spread says nothing.
    if (std::isnan(sigma)) measurement.z(static_cast<Eigen::Index>(i)) = kNaN;
  }
  measurement.guess = read_guess(csv, layout, row);
  if (layout.sensor.empty()) return measurement;

  SensorState sensor;
  sensor.position_m << row[layout.sensor[0]], row[layout.sensor[1]];
  if (layout.sensor.size() == 4) sensor.velocity_mps << row[layout.sensor[2]], row[layout.sensor[3]];
  if (sensor.position_m.allFinite() && sensor.velocity_mps.allFinite())
    measurement.sensor = sensor;
  else
    measurement.z.setConstant(kNaN);  // a measurement from an unknown place says nothing either
  return measurement;
}

BoundedVector read_truth(const CsvLayout& layout, const std::vector<double>& row) {
  BoundedVector x = BoundedVector::Constant(static_cast<Eigen::Index>(layout.truth.size()), kNaN);
  for (std::size_t i = 0; i < layout.truth.size(); ++i)
    if (const auto& column = layout.truth[i]) x(static_cast<Eigen::Index>(i)) = row[column->index] * column->factor;
  return x;
}

Recording read_rows(RecordingReader reader) {
  Recording recording;
  while (reader.next()) reader.append_to(recording);
  reader.complete(recording);
  return recording;
}

std::vector<double> file_factors(const std::vector<std::string>& names) {
  std::vector<double> factors;
  for (const std::string& name : names) {
    const Unit* unit = find_unit(name);
    if (!unit) throw InputError(name, "names no known unit", valid_units());
    factors.push_back(unit->factor);
  }
  return factors;
}

void write_vector(CsvWriter& csv, const BoundedVector& values, const std::vector<double>& factors) {
  for (std::size_t i = 0; i < factors.size(); ++i)
    csv.number(values.size() > 0 ? values(static_cast<Eigen::Index>(i)) / factors[i] : kNaN);
}

}  // namespace

struct RecordingReader::Log {
  explicit Log(CsvReader reader) : csv(std::move(reader)), layout(read_csv_layout(csv)) {
    recording.measured = layout.measured;
  }

  CsvReader csv;
  CsvLayout layout;
  Recording recording;  // its columns and counts, without measurements
  std::vector<double> row;
  Measurement measurement;
  BoundedVector truth;
};

RecordingReader::RecordingReader(const std::filesystem::path& path) : log_(std::make_unique<Log>(CsvReader(path))) {}

RecordingReader::RecordingReader(std::istream& stream, const std::string& name)
    : log_(std::make_unique<Log>(CsvReader(stream, name))) {}

RecordingReader::RecordingReader(RecordingReader&&) noexcept = default;
RecordingReader::~RecordingReader() = default;

const std::vector<std::string>& RecordingReader::measured() const {
  return log_->layout.measured;
}

const StateSpace* RecordingReader::truth_space() const {
  return log_->layout.truth_space;
}

bool RecordingReader::next() {
  CsvReader& csv = log_->csv;
  const CsvLayout& layout = log_->layout;
  std::vector<double>& previous = log_->row;
  while (csv.next()) {
    std::vector<double> row = read_numbers(csv);
    const double time_s = row[layout.time];
    if (std::isnan(time_s)) throw csv.error(layout.time, "is missing or infinite", "a finite time");
    if (!previous.empty() && time_s < previous[layout.time])
      throw csv.error(layout.time,
                      fmt::format("is {}, earlier than {} in the row before", time_s, previous[layout.time]),
                      "times that do not decrease");
    if (identical(row, previous)) {
      ++log_->recording.counts.repeated;
      continue;
    }
    log_->measurement = read_measurement(csv, layout, row);
    log_->recording.counts.missing += is_unusable(log_->recording, log_->measurement);
    if (layout.truth_space) log_->truth = read_truth(layout, row);
    previous = std::move(row);
    return true;
  }
  if (previous.empty()) throw InputError(csv.name(), "has no rows", "at least one measurement");
  return false;
}

const Measurement& RecordingReader::measurement() const {
  return log_->measurement;
}

const BoundedVector& RecordingReader::truth() const {
  return log_->truth;
}

const Recording::Counts& RecordingReader::counts() const {
  return log_->recording.counts;
}

bool RecordingReader::may_wait() const {
  return log_->csv.may_wait();
}

void RecordingReader::append_to(Recording& recording) const {
  recording.measurements.push_back(log_->measurement);
  if (!truth_space()) return;
  recording.truth.resize(1);
  recording.truth[0].x.push_back(log_->truth);
}

void RecordingReader::complete(Recording& recording) const {
  recording.measured = measured();
  recording.truth_space = truth_space();
  recording.counts = counts();
  if (!truth_space()) return;
  std::vector<double> time_s;
  for (const Measurement& measurement : recording.measurements) time_s.push_back(measurement.time_s);
  std::vector<bool> given;
  for (const auto& column : log_->layout.truth) given.push_back(column.has_value());
  complete_velocities(*truth_space(), given, time_s, recording.truth[0].x);
}

Recording read_recording(const std::filesystem::path& path) {
  return read_rows(RecordingReader(path));
}

Recording read_recording(std::istream& stream, const std::string& name) {
  return read_rows(RecordingReader(stream, name));
}

std::string write_recording(const Recording& recording) {
  if (recording.truth.size() > 1)
    throw InputError("recording", fmt::format("has {} true tracks", recording.truth.size()), "at most one in a log");
  const auto any = [&](const auto& predicate) {
    return std::any_of(recording.measurements.begin(), recording.measurements.end(), predicate);
  };
  const bool has_sigma = any([](const Measurement& m) { return m.sigma.size() > 0; });
  const bool has_sensor = any([](const Measurement& m) { return m.sensor.has_value(); });
  const bool has_guess = any([](const Measurement& m) { return m.guess.has_value(); });
  const bool has_speed = any([](const Measurement& m) { return m.guess && std::isfinite(m.guess->speed_mps); });
  const auto guess_end = has_speed ? kGuessColumns.end() : kGuessColumns.begin() + 2;
  const bool has_truth = !recording.truth.empty();
  const std::vector<double> z_factors = file_factors(recording.measured);
  const std::vector<double> x_factors = has_truth ? file_factors(recording.truth_space->components) : z_factors;

  std::vector<std::string> header{"time_s"};
  header.insert(header.end(), recording.measured.begin(), recording.measured.end());
  if (has_sigma)
    for (const std::string& name : recording.measured) header.push_back(sigma_column(name));
  if (has_sensor) header.insert(header.end(), kSensorColumns.begin(), kSensorColumns.end());
  if (has_guess) header.insert(header.end(), kGuessColumns.begin(), guess_end);
  if (has_truth)
    for (const std::string& component : recording.truth_space->components)
      header.push_back(std::string(kTruthPrefix) + component);

  CsvWriter csv(header);
  for (std::size_t k = 0; k < recording.measurements.size(); ++k) {
    const Measurement& measurement = recording.measurements[k];
    csv.number(measurement.time_s);
    write_vector(csv, measurement.z, z_factors);
    if (has_sigma) write_vector(csv, measurement.sigma, z_factors);
    if (has_sensor) {
      const Eigen::Vector2d unknown = Eigen::Vector2d::Constant(kNaN);
      const SensorState sensor = measurement.sensor.value_or(SensorState{unknown, unknown});
      for (const double value : sensor.position_m) csv.number(value);
      for (const double value : sensor.velocity_mps) csv.number(value);
    }
    if (has_guess) {
      const TargetGuess guess = measurement.guess.value_or(TargetGuess{kNaN, kNaN});
      csv.number(guess.range_m);
      csv.number(guess.range_sigma_m);
      if (has_speed) csv.number(guess.speed_mps);
      if (has_speed) csv.number(guess.speed_sigma_mps);
    }
    if (has_truth) write_vector(csv, recording.truth[0].x[k], x_factors);
    csv.end_row();
  }
  return csv.str();
}

}  // namespace truebearing
