// SPDX-License-Identifier: Apache-2.0
#include "truebearing/recording/snapshot_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "truebearing/core/angle.hpp"
#include "truebearing/core/constants.hpp"
#include "truebearing/core/error.hpp"
#include "truebearing/io/file.hpp"
#include "truebearing/io/hdf5_file.hpp"
#include "truebearing/recording/velocity_truth.hpp"

namespace truebearing {
namespace {

using Complex = std::complex<double>;
using Shape = std::vector<std::uint64_t>;

constexpr Complex kNothing{kNaN, kNaN};

constexpr const char* kSnapshots = "snapshots";
constexpr const char* kTime = "time_s";
constexpr const char* kAngle = "truth_angle_deg";
constexpr const char* kRate = "truth_rate_degps";

constexpr std::uint64_t kMaxIntervals = 1'000'000;
constexpr std::uint64_t kMaxSnapshots = 1'000'000;
constexpr std::uint64_t kMaxSensors = 4096;
constexpr std::uint64_t kMaxBytes = std::uint64_t{1} << 31;
constexpr std::uint64_t kMaxTargets = 256;
constexpr std::uint64_t kMaxTruths = 10'000'000;

/// Of one array: what every interval has in common.
struct SnapshotLayout {
  std::uint64_t intervals = 0;
  std::uint64_t snapshots = 0;
  std::uint64_t sensors = 0;
  double interval_s = 0.0;
  double spacing_wavelengths = 0.0;

  std::size_t values_per_interval() const { return static_cast<std::size_t>(snapshots * sensors); }
};

std::string text_of(const Shape& shape) {
  return fmt::format("({})", fmt::join(shape, ", "));
}

void check_size(const SnapshotLayout& layout, const std::string& where) {
  const auto within = [](std::uint64_t size, std::uint64_t most) { return size >= 1 && size <= most; };
  if (!within(layout.intervals, kMaxIntervals) || !within(layout.snapshots, kMaxSnapshots) ||
      !within(layout.sensors, kMaxSensors))
    throw InputError(where,
                     fmt::format("has {} intervals of {} snapshots of {} sensors", layout.intervals, layout.snapshots,
                                 layout.sensors),
                     fmt::format("1 to {} intervals, 1 to {} snapshots, 1 to {} sensors", kMaxIntervals, kMaxSnapshots,
                                 kMaxSensors));
  const std::uint64_t bytes = layout.intervals * layout.snapshots * layout.sensors * sizeof(Complex);
  if (bytes > kMaxBytes)
    throw InputError(where, fmt::format("takes {} bytes", bytes), fmt::format("at most {}", kMaxBytes));
}

void check_targets(std::uint64_t intervals, std::uint64_t targets, const std::string& where) {
  if (targets < 1 || targets > kMaxTargets)
    throw InputError(where, fmt::format("has {} targets", targets), fmt::format("1 to {}", kMaxTargets));
  if (intervals * targets > kMaxTruths)
    throw InputError(where, fmt::format("holds {} true states", intervals * targets),
                     fmt::format("at most {}", kMaxTruths));
}

std::optional<double> attribute(const Hdf5Reader& file, const char* name, bool positive) {
  const std::optional<double> value = file.attribute(kSnapshots, name);
  if (value && !(std::isfinite(*value) && (!positive || *value > 0.0)))
    throw InputError(file.where(kSnapshots) + ": " + name, fmt::format("is {}", *value),
                     positive ? "a finite number > 0" : "a finite number");
  return value;
}

double required_attribute(const Hdf5Reader& file, const char* name) {
  const std::optional<double> value = attribute(file, name, true);
  if (!value) throw InputError(file.where(kSnapshots), fmt::format("has no attribute {}", name), "a number > 0");
  return *value;
}

double read_spacing(const Hdf5Reader& file) {
  constexpr double kSoundInWater_mps = 1500.0;
  constexpr const char* kValid = "spacing_wavelengths, or spacing_m and frequency_hz";
  const std::optional<double> wavelengths = attribute(file, "spacing_wavelengths", true);
  const std::optional<double> spacing_m = attribute(file, "spacing_m", true);
  if (wavelengths.has_value() == spacing_m.has_value())
    throw InputError(file.where(kSnapshots),
                     wavelengths ? "has both the attributes spacing_wavelengths and spacing_m"
                                 : "has no attribute that tells how far its sensors are apart",
                     kValid);
  if (wavelengths) return *wavelengths;
  const double wavelength_m =
      attribute(file, "sound_mps", true).value_or(kSoundInWater_mps) / required_attribute(file, "frequency_hz");
  return *spacing_m / wavelength_m;
}

SnapshotLayout read_snapshot_layout(const Hdf5Reader& file) {
  constexpr const char* kValid = "(interval, snapshot, sensor, 2), real and imaginary part";
  if (!file.has(kSnapshots))
    throw InputError(file.where(kSnapshots), "is missing", fmt::format("a dataset {}", kValid));
  const Shape shape = file.shape(kSnapshots);
  if (shape.size() != 4 || shape[3] != 2)
    throw InputError(file.where(kSnapshots), "is of shape " + text_of(shape), kValid);
  SnapshotLayout layout;
  layout.intervals = shape[0];
  layout.snapshots = shape[1];
  layout.sensors = shape[2];
  check_size(layout, file.where(kSnapshots));
  layout.interval_s = required_attribute(file, "interval_s");
  layout.spacing_wavelengths = read_spacing(file);
  return layout;
}

std::vector<double> read_times(const Hdf5Reader& file, const SnapshotLayout& layout) {
  std::vector<double> time_s(layout.intervals);
  if (!file.has(kTime)) {
    const double first_time_s = attribute(file, "first_time_s", false).value_or(0.0);
    for (std::size_t k = 0; k < time_s.size(); ++k)
      time_s[k] = first_time_s + static_cast<double>(k) * layout.interval_s;
    return time_s;
  }
  if (const Shape shape = file.shape(kTime); shape != Shape{layout.intervals})
    throw InputError(file.where(kTime), "is of shape " + text_of(shape),
                     fmt::format("{}, one per interval", text_of({layout.intervals})));
  file.read(kTime, time_s);
  for (std::size_t k = 0; k < time_s.size(); ++k) {
    const std::string where = fmt::format("{}[{}]", file.where(kTime), k);
    if (!std::isfinite(time_s[k])) throw InputError(where, fmt::format("is {}", time_s[k]), "a finite time");
    if (k > 0 && time_s[k] < time_s[k - 1])
      throw InputError(where, fmt::format("is {}, earlier than {} before it", time_s[k], time_s[k - 1]),
                       "times that do not decrease");
  }
  return time_s;
}

/// Of all targets, interval by interval, in radians; empty where the file has none.
struct TruthTable {
  std::size_t targets = 0;
  std::vector<double> angle_rad;
  std::vector<double> rate_radps;

  double& angle(std::size_t interval, std::size_t target) { return angle_rad[interval * targets + target]; }
  double& rate(std::size_t interval, std::size_t target) { return rate_radps[interval * targets + target]; }
};

std::vector<double> read_degrees(const Hdf5Reader& file, const char* name, std::size_t size) {
  file.check_holds(name, size);
  std::vector<double> values(size);
  file.read(name, values);
  for (double& value : values) value = std::isfinite(value) ? radians(value) : kNaN;
  return values;
}

TruthTable read_truth(const Hdf5Reader& file, const std::vector<double>& time_s) {
  TruthTable truth;
  if (!file.has(kAngle)) {
    if (file.has(kRate)) throw InputError(file.where(kRate), "stands alone", fmt::format("{} beside it", kAngle));
    return truth;
  }
  const std::size_t intervals = time_s.size();
  const Shape shape = file.shape(kAngle);
  if (shape.size() != 2 || shape[0] != intervals)
    throw InputError(file.where(kAngle), "is of shape " + text_of(shape), fmt::format("({}, targets)", intervals));
  check_targets(intervals, shape[1], file.where(kAngle));
  truth.targets = static_cast<std::size_t>(shape[1]);
  truth.angle_rad = read_degrees(file, kAngle, intervals * truth.targets);
  if (file.has(kRate)) {
    if (const Shape rates = file.shape(kRate); rates != shape)
      throw InputError(file.where(kRate), "is of shape " + text_of(rates),
                       fmt::format("{}, as {}", text_of(shape), kAngle));
    truth.rate_radps = read_degrees(file, kRate, intervals * truth.targets);
    return truth;
  }
  truth.rate_radps.resize(truth.angle_rad.size());
  std::vector<double> angle_rad(intervals);
  for (std::size_t target = 0; target < truth.targets; ++target) {
    for (std::size_t k = 0; k < intervals; ++k) angle_rad[k] = truth.angle(k, target);
    const std::vector<double> rate_radps = velocity_truth(time_s, angle_rad);
    for (std::size_t k = 0; k < intervals; ++k) truth.rate(k, target) = rate_radps[k];
  }
  return truth;
}

std::vector<Complex> read_values(const Hdf5Reader& file, const SnapshotLayout& layout) {
  const std::size_t size = layout.intervals * layout.values_per_interval();
  file.check_holds(kSnapshots, 2 * size);
  std::vector<Complex> values(size);
  // A complex number is an array of its two parts: [complex.numbers.general].
  file.read(kSnapshots, {reinterpret_cast<double*>(values.data()), 2 * values.size()});
  for (Complex& value : values)
    if (std::isinf(value.real()) || std::isinf(value.imag())) value = kNothing;
  return values;
}

bool same(double a, double b) {
  return a == b || (std::isnan(a) && std::isnan(b));
}
bool same(std::span<const Complex> a, std::span<const Complex> b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](Complex x, Complex y) { return same(x.real(), y.real()) && same(x.imag(), y.imag()); });
}

// Numbers targets as trackers of angles do that begin them all at once: those that are there from the first
// measurement in the order of their angles, the others behind them in the order in which they stand.
void number_by_first_angle(std::vector<Truth>& truth) {
  std::vector<std::size_t> order(truth.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto first_rad = [&](std::size_t n) { return truth[n].x.empty() ? kNaN : truth[n].x.front()[0]; };
  const auto later =
      std::stable_partition(order.begin(), order.end(), [&](std::size_t n) { return std::isfinite(first_rad(n)); });
  std::stable_sort(order.begin(), later, [&](std::size_t a, std::size_t b) { return first_rad(a) < first_rad(b); });
  for (std::size_t place = 0; place < order.size(); ++place) truth[order[place]].track = static_cast<int>(place);
}

Recording make_recording(const SnapshotLayout& layout, const std::vector<double>& time_s, TruthTable& truth,
                         std::vector<Complex> values) {
  Recording recording;
  recording.measured = {kSnapshots};
  if (truth.targets > 0) recording.truth_space = &angle_space();
  recording.truth.resize(truth.targets);
  recording.snapshots = std::make_shared<const std::vector<Complex>>(std::move(values));

  const std::span<const Complex> all(*recording.snapshots);
  const std::size_t size = layout.values_per_interval();
  for (std::size_t k = 0; k < time_s.size(); ++k) {
    const std::span<const Complex> block = all.subspan(k * size, size);
    if (k > 0 && time_s[k] == time_s[k - 1] && same(block, all.subspan((k - 1) * size, size))) {
      ++recording.counts.repeated;
      continue;
    }
    Measurement measurement;
    measurement.time_s = time_s[k];
    measurement.snapshots = {block, static_cast<int>(layout.sensors), layout.spacing_wavelengths, layout.interval_s};
    recording.counts.missing += is_unusable(recording, measurement);
    recording.measurements.push_back(std::move(measurement));
    for (std::size_t target = 0; target < truth.targets; ++target)
      recording.truth[target].x.emplace_back(Eigen::Vector2d(truth.angle(k, target), truth.rate(k, target)));
  }
  number_by_first_angle(recording.truth);
  return recording;
}

/// What the recording's intervals have in common; throws where they have not.
SnapshotLayout snapshot_layout(const Recording& recording, const std::string& name) {
  if (!measures_snapshots(recording.measured))
    throw InputError(name, fmt::format("would hold {}", fmt::join(recording.measured, ", ")),
                     "the snapshots of a line array");
  const std::vector<Measurement>& measurements = recording.measurements;
  const auto first = std::find_if(measurements.begin(), measurements.end(),
                                  [](const Measurement& measurement) { return measurement.snapshots.has_value(); });
  if (first == measurements.end()) throw InputError(name, "would hold no snapshots", "those of one interval at least");
  const SnapshotBlock& array = *first->snapshots;
  for (const Measurement& measurement : measurements) {
    const SnapshotBlock& block = measurement.snapshots.value_or(array);
    if (block.values.size() != array.values.size() || block.sensors != array.sensors ||
        block.interval_s != array.interval_s || block.spacing_wavelengths != array.spacing_wavelengths)
      throw InputError(name, fmt::format("would hold another array or interval at {} s", measurement.time_s),
                       "one array, and as many snapshots in every interval");
  }
  const SnapshotLayout layout{measurements.size(), static_cast<std::uint64_t>(array.snapshots()),
                              static_cast<std::uint64_t>(array.sensors), array.interval_s, array.spacing_wavelengths};
  check_size(layout, name);
  const auto positive = [](double value) { return std::isfinite(value) && value > 0.0; };
  if (!positive(layout.interval_s) || !positive(layout.spacing_wavelengths))
    throw InputError(name,
                     fmt::format("would hold intervals of {} s and a spacing of {} wavelengths", layout.interval_s,
                                 layout.spacing_wavelengths),
                     "finite numbers > 0");
  return layout;
}

void check_times(const Recording& recording, const std::string& name) {
  double last_time_s = -std::numeric_limits<double>::max();
  for (const Measurement& measurement : recording.measurements) {
    if (!std::isfinite(measurement.time_s) || measurement.time_s < last_time_s)
      throw InputError(name, fmt::format("would hold the time {} s after {} s", measurement.time_s, last_time_s),
                       "finite times that do not decrease");
    last_time_s = measurement.time_s;
  }
}

void write_truth(Hdf5Writer& file, const Recording& recording, const std::string& name) {
  if (recording.truth.empty()) return;
  if (!recording.truth_space || *recording.truth_space != angle_space())
    throw InputError(name, "would hold another truth than a line array's",
                     fmt::format("{}", fmt::join(angle_space().components, ", ")));
  const std::size_t targets = recording.truth.size();
  check_targets(recording.measurements.size(), targets, name);
  for (const auto& [dataset, component] : {std::pair(kAngle, 0), std::pair(kRate, 1)}) {
    file.add(dataset, {recording.measurements.size(), targets});
    std::vector<double> row(targets);
    for (std::size_t k = 0; k < recording.measurements.size(); ++k) {
      for (std::size_t target = 0; target < targets; ++target) {
        const BoundedVector& x = recording.truth[target].x[k];
        row[target] = x.size() > component ? degrees(x[component]) : kNaN;
      }
      file.write_row(dataset, k, row);
    }
  }
}

}  // namespace

bool is_snapshot_log(const std::filesystem::path& path) {
  return path.extension() == ".h5" || path.extension() == ".hdf5" || is_hdf5_file(path);
}

Recording read_snapshot_log(const std::filesystem::path& path) {
  return read_snapshot_log(Hdf5Reader(path));
}

Recording read_snapshot_log(const Hdf5Reader& file) {
  const SnapshotLayout layout = read_snapshot_layout(file);
  const std::vector<double> time_s = read_times(file, layout);
  TruthTable truth = read_truth(file, time_s);
  return make_recording(layout, time_s, truth, read_values(file, layout));
}

void write_snapshot_log(const std::filesystem::path& path, const Recording& recording) {
  const std::string name = path.string();
  const SnapshotLayout layout = snapshot_layout(recording, name);
  check_times(recording, name);
  Hdf5Writer file(name);
  file.add(kSnapshots, {layout.intervals, layout.snapshots, layout.sensors, 2});
  file.add_attribute(kSnapshots, "interval_s", layout.interval_s);
  file.add_attribute(kSnapshots, "spacing_wavelengths", layout.spacing_wavelengths);
  file.add(kTime, {layout.intervals});
  const std::vector<Complex> nothing(layout.values_per_interval(), kNothing);
  for (std::size_t k = 0; k < recording.measurements.size(); ++k) {
    const Measurement& measurement = recording.measurements[k];
    const std::span<const Complex> values = measurement.snapshots ? measurement.snapshots->values : nothing;
    file.write_row(kSnapshots, k, {reinterpret_cast<const double*>(values.data()), 2 * values.size()});
    file.write_row(kTime, k, {&measurement.time_s, 1});
  }
  write_truth(file, recording, name);
  write_file_atomically(path, file.str());
}

}  // namespace truebearing
