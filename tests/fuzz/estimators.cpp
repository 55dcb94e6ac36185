// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/estimators.hpp"

#include <array>
#include <map>
#include <stdexcept>

#include "tests/fuzz/bytes.hpp"
#include "tests/support/stream_invariants.hpp"
#include "truebearing/study/study.hpp"

namespace truebearing::testing {
namespace {

// One of each structure. Inputs in the corpus choose by place: new ones stand at the end.
struct Choice {
  const char *study, *tracker;
};
constexpr std::array kChoices{
    Choice{"radar_1d_family", "tuned"},
    Choice{"radar_1d_family", "tuned_qr"},
    Choice{"radar_1d_family", "nfnn"},
    Choice{"radar_1d_family", "bayes_bank"},
    Choice{"radar_1d_flight", "raw"},
    Choice{"manoeuvre_2d", "tuned"},
    Choice{"manoeuvre_2d", "imm6"},
    Choice{"manoeuvre_2d", "imm6_nfnn"},
    Choice{"radar_2d", "imm6"},
    Choice{"bearings_only_family", "ekf"},
    Choice{"bearings_only_family", "ukf_plain"},
    Choice{"bearings_only_family", "log_polar"},
    Choice{"bearings_only_family", "bank_6"},
    Choice{"bearings_only_family", "nfnn_ekf"},
    Choice{"bearings_only_m", "modified_gain"},
    Choice{"bearings_only_m", "map"},
    Choice{"passive_sonar_a", "ekf"},
    Choice{"passive_sonar_a", "ukf"},
    Choice{"passive_sonar_a", "ml"},
    Choice{"passive_sonar_turn", "imm2"},
    Choice{"passive_sonar_turn", "ekf"},
    Choice{"passive_sonar_turns", "imm2_nfnn"},
    Choice{"array_random", "lag_fixed"},
    Choice{"array_random", "improved"},
    Choice{"array_random", "joint"},
    Choice{"array_births", "joint"},
};

struct Estimator {
  std::unique_ptr<Tracker> tracker;
  Eigen::Index components = 0;
  int sensors = 0;  ///< of a line array
};

// Made once: a study takes longer to read than a stream to go through.
Estimator& estimator(std::size_t choice) {
  static std::map<std::string, Study> studies;
  static std::array<Estimator, kChoices.size()> estimators;
  Estimator& one = estimators[choice];
  if (one.tracker) return one;
  const auto& [name, tracker] = kChoices[choice];
  auto study = studies.find(name);
  if (study == studies.end())
    study = studies.emplace(name, Study::load(fmt::format(TRUEBEARING_SOURCE_DIR "/data/studies/{}.toml", name))).first;
  one.tracker = study->second.make_tracker(tracker);
  const Measured measured = one.tracker->measures().value();
  if (measured == Measured::snapshots())
    one.sensors = study->second.scenario().measured().value().sensors;
  else
    one.components = static_cast<Eigen::Index>(measured.components.size());
  return one;
}

void add_block(Bytes& bytes, int sensors, Stream& stream) {
  const unsigned shape = bytes.take();
  if (shape % 8 == 1) return;
  if (shape % 8 == 2) sensors = 1 + static_cast<int>(bytes.take() % 20);
  const double spacing = shape % 8 == 3 ? bytes.magnitude() : 0.5;
  const double interval_s = shape % 8 == 4 ? bytes.magnitude() : 1.0;
  const double scale = shape % 8 == 5 ? bytes.number() : 1.0;
  RandomStream random({.seed = shape}, StreamId::test);
  std::vector<std::complex<double>>& block =
      stream.add_block(sensors, shape % 8 == 6 ? 1 + bytes.take() % 4 : 30, spacing, interval_s);
  for (std::complex<double>& value : block) value = scale * std::complex<double>(random.normal(), random.normal());
  for (unsigned altered = shape / 64; altered > 0; --altered) {
    std::complex<double>& value = block[bytes.take(2) % block.size()];
    value = {bytes.number(), bytes.number()};
  }
}

// What the bytes say, after that many rows in which nothing is wrong. Few rows: an input that is quick is soon followed by
// others. What takes over from a batch after a thousand seconds gets there in slow ones.
Stream stream_of(Bytes& bytes, const Estimator& estimator) {
  constexpr std::size_t kMostRows = 24, kMostBlocks = 6;
  Stream stream;
  const unsigned seed = bytes.take(), opening = estimator.sensors > 0 ? seed % 4 : seed % 16;
  const double slowness = estimator.sensors == 0 && seed & 32 ? 5.0 : 1.0;
  RandomStream random({.seed = seed}, StreamId::test);
  for (unsigned k = 1; k <= opening; ++k) {
    add_tame_row(static_cast<int>(k), estimator.components, estimator.sensors, random, stream);
    stream.measurements.back().time_s *= slowness;
  }
  double time_s = stream.measurements.empty() ? 0.0 : stream.measurements.back().time_s;
  while (!bytes.empty() && stream.measurements.size() < (estimator.sensors > 0 ? kMostBlocks : kMostRows)) {
    const unsigned row = bytes.take();
    Measurement& measurement = stream.measurements.emplace_back();
    time_s += row % 4 == 3 ? bytes.number() : row % 4 == 2 ? 0.0 : 0.125 * bytes.take();
    measurement.time_s = time_s;
    if (!std::isfinite(time_s)) time_s = 0.0;
    measurement.z = BoundedVector::NullaryExpr(estimator.components, [&] { return bytes.number(); });
    if (row & 4)
      measurement.sigma = BoundedVector::NullaryExpr(estimator.components, [&] { return bytes.magnitude(); });
    if (!(row & 8)) measurement.sensor = SensorState{{10.0 * time_s, 0.0}, {10.0, 0.0}};
    if (row & 16) measurement.sensor = SensorState{{bytes.number(), bytes.number()}, {bytes.number(), bytes.number()}};
    if (row & 32) measurement.guess = TargetGuess{bytes.number(), bytes.number(), bytes.number(), bytes.number()};
    if (row & 64) measurement.z.setConstant(kNaN);
    if (estimator.sensors > 0) add_block(bytes, estimator.sensors, stream);
  }
  return stream;
}

void require(bool holds, const char* tracker, const std::string& broken) {
  if (!holds) throw std::logic_error(fmt::format("{}: {}", tracker, broken));
}

// Once more, and between two rows whose times rise an empty one: what is published at the rows themselves stays as it
// was. The slowest of all that is driven here is the trackers' own work, which is done twice and no more.
void check_again(Tracker& tracker, const Stream& stream, const std::vector<Published>& expected, const char* name) {
  tracker.reset();
  const std::vector<Measurement>& rows = stream.measurements;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    require(published(tracker, {&rows[k], 1}) == expected[k], name,
            fmt::format("a reset does not give the same bits, or an empty row leaves a trace, at row {}", k));
    if (k + 1 == rows.size() || !(rows[k].time_s < rows[k + 1].time_s)) continue;
    const Measurement empty = emptied(rows[k], 0.5 * (rows[k].time_s + rows[k + 1].time_s));
    require(published(tracker, {&empty, 1}).fault.empty(), name, "what is published at an empty row is not finite");
  }
}

}  // namespace

bool drive_estimator(std::span<const std::uint8_t> all) {
  if (all.empty()) return false;
  Bytes bytes(all);
  const std::size_t choice = bytes.take() % kChoices.size();
  const char* const name = kChoices[choice].tracker;
  Estimator& one = estimator(choice);
  const Stream stream = stream_of(bytes, one);
  one.tracker->reset();
  std::vector<Published> first;  // [row]
  bool any = false;
  for (const Measurement& row : stream.measurements) {
    first.push_back(published(*one.tracker, {&row, 1}));
    require(first.back().fault.empty(), name, first.back().fault);
    any |= !first.back().rows.empty();
  }
  check_again(*one.tracker, stream, first, name);
  return any;
}

}  // namespace truebearing::testing
