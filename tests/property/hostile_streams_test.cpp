// SPDX-License-Identifier: Apache-2.0
// Streams of hostile values through every tracker of every study: what is published is finite or `failed`, no variance is
// below zero, a reset gives the same bits, and an empty row leaves no trace. TRUEBEARING_STREAMS through each tracker, a
// hundred where it is not set (CONTRIBUTING.md); of those of an array, whose streams are thousands of values each, a tenth.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/environment.hpp"
#include "tests/support/stream_invariants.hpp"
#include "truebearing/study/study.hpp"
#include "truebearing/tracker/particle_limit.hpp"

namespace truebearing::hostile_streams_test {
namespace {

using testing::Published;
using testing::published;
using testing::Stream;

constexpr int kSteps = 25;
constexpr int kTameRows = 60;

int streams() {
  return testing::number_from_environment("TRUEBEARING_STREAMS", 100);
}

std::vector<std::string> studies() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(TRUEBEARING_SOURCE_DIR "/data/studies"))
    names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

double hostile(RandomStream& random) {
  constexpr std::array kValues{0.0,  -0.0, 1e-308, 5e-324, 1.0,     -1.0,     1e3,       1e7,  1e8,
                               1e15, 1e30, 1e100,  1e154,  1.7e308, -1.7e308, kInfinity, kNaN, -kInfinity};
  if (random.uniform() < 0.6) return 1e4 * random.normal();
  return kValues[random.index(kValues.size())] * (random.uniform() < 0.5 ? 1.0 : -1.0);
}

// What a tracker takes: numbers, or the snapshots of that many sensors.
struct Taken {
  Eigen::Index components = 0;
  int sensors = 0;
  std::vector<Source> sources{};  ///< where several take turns
};

std::optional<Taken> taken_by(const Tracker& tracker, const Study& study) {
  const std::optional<Measured> measured = tracker.measures();
  if (!measured) return std::nullopt;
  if (*measured == Measured::snapshots()) return Taken{0, study.scenario().measured().value().sensors};
  return Taken{static_cast<Eigen::Index>(measured->components.size()), 0, measured->sources};
}

// Where several sensors take turns: each measurement is one's, now and then of one that there is not.
void share_out(const Taken& taken, double unknown_share, RandomStream& random, Stream& stream) {
  if (taken.sources.empty()) return;
  for (Measurement& measurement : stream.measurements) {
    const std::size_t source = random.index(taken.sources.size());
    measurement.source = random.uniform() < unknown_share ? -1 : static_cast<int>(source);
    const auto size = static_cast<Eigen::Index>(taken.sources[source].components.size());
    measurement.z.conservativeResize(size);
    if (measurement.sigma.size() > 0) measurement.sigma.conservativeResize(size);
  }
}

// Most blocks are noise of the array that the others are of, with hostile values here and there.
void add_hostile_block(int sensors, RandomStream& random, Stream& stream) {
  if (random.uniform() < 0.1) return;
  if (random.uniform() < 0.1) sensors = 1 + static_cast<int>(random.index(20));
  const double spacing = random.uniform() < 0.1 ? std::abs(hostile(random)) : 0.5;
  const double interval_s = random.uniform() < 0.1 ? std::abs(hostile(random)) : 1.0;
  const int count = random.uniform() < 0.2 ? 1 + static_cast<int>(random.index(3)) : 30;
  const double rarity = random.uniform() < 0.5 ? 0.0 : 0.1 * random.uniform();
  const double scale = random.uniform() < 0.1 ? hostile(random) : 1.0;
  for (std::complex<double>& value : stream.add_block(sensors, count, spacing, interval_s)) {
    value = {scale * random.normal(), scale * random.normal()};
    if (random.uniform() < rarity) value = {hostile(random), hostile(random)};
  }
}

// Hostile values, after `opening` tame rows: some trackers begin with a batch of those alone.
Stream hostile_stream(int opening, const Taken& taken, RandomStream& random) {
  Stream stream;
  for (int k = 1; k <= opening; ++k) add_tame_row(k, taken.components, taken.sensors, random, stream);
  double time_s = opening > 0 ? stream.measurements.back().time_s : 0.0;
  const double opened_s = time_s;
  for (int k = 0; k < kSteps; ++k) {
    const double kind = random.uniform();
    time_s += kind < 0.8 ? 1.0 + 9.0 * random.uniform() : kind < 0.9 ? 0.0 : hostile(random);
    Measurement& measurement = stream.measurements.emplace_back();
    measurement.time_s = time_s;
    if (!std::isfinite(time_s)) time_s = opened_s + 10.0 * k;
    measurement.z = BoundedVector::NullaryExpr(taken.components, [&] { return hostile(random); });
    if (random.uniform() < 0.3)
      measurement.sigma = BoundedVector::NullaryExpr(taken.components, [&] { return std::abs(hostile(random)); });
    if (random.uniform() < 0.8)
      measurement.sensor = SensorState{Eigen::Vector2d(10.0 * time_s, random.uniform() < 0.05 ? hostile(random) : 0.0),
                                       Eigen::Vector2d(10.0, 0.0)};
    if (random.uniform() < 0.3)
      measurement.guess = TargetGuess{std::abs(hostile(random)), std::abs(hostile(random)), std::abs(hostile(random)),
                                      std::abs(hostile(random))};
    if (taken.sensors > 0) add_hostile_block(taken.sensors, random, stream);
  }
  share_out(taken, 0.05, random, stream);
  return stream;
}

class HostileStreams : public ::testing::TestWithParam<std::string> {};

TEST_P(HostileStreams, BreakNoTracker) {
  const Study study = Study::load(std::string(TRUEBEARING_SOURCE_DIR "/data/studies/") + GetParam() + ".toml");
  std::size_t rows = 0, streamed = 0;
  for (const TrackerSpec& spec : study.trackers()) {
    const std::unique_ptr<Tracker> tracker = study.make_tracker(spec.name);
    const std::optional<Taken> taken = taken_by(*tracker, study);
    if (!taken) continue;
    RandomStream random({.seed = 31}, StreamId::test);
    // Of an array's thousands of values, and through tens of thousands of particles, fewer.
    const int share = dynamic_cast<const ParticleLimit*>(tracker.get()) ? 50 : taken->sensors > 0 ? 10 : 1;
    const int count = std::max(1, streams() / share);
    for (int number = 0; number < count; ++number) {
      SCOPED_TRACE(spec.name + ", stream " + std::to_string(number));
      const int opening = taken->sensors > 0 ? number % 5 : number % 20 == 0 ? kTameRows : 0;
      const Stream stream = hostile_stream(opening, *taken, random);
      tracker->reset();
      tracker->foresee(stream.measurements);
      const Published first = published(*tracker, stream.measurements);
      ASSERT_EQ(first.fault, "");
      rows += first.rows.size();
      ++streamed;
      tracker->reset();
      tracker->foresee(stream.measurements);
      ASSERT_TRUE(published(*tracker, stream.measurements) == first) << "after a reset";
    }
  }
  fmt::print("{} streams through {} trackers, {} records\n", streamed, study.trackers().size(), rows);
  EXPECT_GT(rows, 0u);
}

// What is published at the rows that hold something, of a target that is at a random place in every one of them.
TEST_P(HostileStreams, EmptyRowsLeaveNoTrace) {
  const Study study = Study::load(std::string(TRUEBEARING_SOURCE_DIR "/data/studies/") + GetParam() + ".toml");
  std::size_t rows = 0;
  for (const TrackerSpec& spec : study.trackers()) {
    const std::unique_ptr<Tracker> without = study.make_tracker(spec.name), with = without->fresh();
    const std::optional<Taken> taken = taken_by(*without, study);
    if (!taken) continue;
    SCOPED_TRACE(spec.name);
    RandomStream random({.seed = 32}, StreamId::test);
    for (int k = 1; k <= kTameRows; ++k) {
      Stream row;
      add_tame_row(k, taken->components, taken->sensors, random, row);
      share_out(*taken, 0.0, random, row);
      const Published expected = published(*without, row.measurements);
      rows += expected.rows.size();
      ASSERT_EQ(expected.fault, "");
      ASSERT_TRUE(published(*with, row.measurements) == expected) << "at row " << k;
      const Measurement empty =
          testing::emptied(row.measurements[0], row.measurements[0].time_s + (taken->sensors > 0 ? 0.4 : 7));
      ASSERT_EQ(published(*with, {&empty, 1}).fault, "") << "at the empty row " << k;
    }
  }
  EXPECT_GT(rows, 0u);
}

INSTANTIATE_TEST_SUITE_P(Studies, HostileStreams, ::testing::ValuesIn(studies()),
                         [](const auto& study) { return study.param; });

}  // namespace
}  // namespace truebearing::hostile_streams_test
