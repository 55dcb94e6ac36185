// SPDX-License-Identifier: Apache-2.0
// Streams of hostile values through every tracker of every study that measures numbers: what is published is finite or
// `failed`, no variance is below zero, a reset gives the same bits, and an empty row leaves no trace.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "truebearing/core/constants.hpp"
#include "truebearing/core/random.hpp"
#include "truebearing/study/study.hpp"

namespace truebearing::hostile_streams_test {
namespace {

constexpr int kStreams = 100;
constexpr int kSteps = 25;
constexpr int kTameRows = 60;

std::vector<std::string> studies() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(TRUEBEARING_SOURCE_DIR "/data/studies"))
    if (const std::string name = entry.path().stem().string(); !name.starts_with("array_")) names.push_back(name);
  std::sort(names.begin(), names.end());
  return names;
}

double hostile(RandomStream& random) {
  constexpr std::array kValues{0.0,  -0.0, 1e-308, 5e-324, 1.0,     -1.0,     1e3,       1e7,  1e8,
                               1e15, 1e30, 1e100,  1e154,  1.7e308, -1.7e308, kInfinity, kNaN, -kInfinity};
  if (random.uniform() < 0.6) return 1e4 * random.normal();
  return kValues[random.index(kValues.size())] * (random.uniform() < 0.5 ? 1.0 : -1.0);
}

// Row k of a log in which nothing is wrong, of a target that is nowhere in particular.
Measurement tame(int k, Eigen::Index components, RandomStream& random) {
  Measurement measurement;
  measurement.time_s = 20.0 * k;
  measurement.z = BoundedVector::NullaryExpr(components, [&] { return 0.3 * random.normal() + 1.0; });
  measurement.sensor = SensorState{Eigen::Vector2d(100.0 * k, 3000.0 * std::sin(0.1 * k)), Eigen::Vector2d(5.0, 0.0)};
  measurement.guess = TargetGuess{8000.0, 2000.0, 5.0, 2.0};
  return measurement;
}

// Hostile values, after `opening` tame rows: some trackers begin with a batch of those alone.
std::vector<Measurement> stream(int opening, Eigen::Index components, RandomStream& random) {
  std::vector<Measurement> measurements;
  for (int k = 1; k <= opening; ++k) measurements.push_back(tame(k, components, random));
  double time_s = 20.0 * opening;
  for (int k = 0; k < kSteps; ++k) {
    const double kind = random.uniform();
    time_s += kind < 0.8 ? 1.0 + 9.0 * random.uniform() : kind < 0.9 ? 0.0 : hostile(random);
    Measurement measurement;
    measurement.time_s = time_s;
    if (!std::isfinite(time_s)) time_s = 20.0 * opening + 10.0 * k;
    measurement.z = BoundedVector::NullaryExpr(components, [&] { return hostile(random); });
    if (random.uniform() < 0.3)
      measurement.sigma = BoundedVector::NullaryExpr(components, [&] { return std::abs(hostile(random)); });
    if (random.uniform() < 0.8)
      measurement.sensor = SensorState{Eigen::Vector2d(10.0 * time_s, random.uniform() < 0.05 ? hostile(random) : 0.0),
                                       Eigen::Vector2d(10.0, 0.0)};
    if (random.uniform() < 0.3)
      measurement.guess = TargetGuess{std::abs(hostile(random)), std::abs(hostile(random)), std::abs(hostile(random)),
                                      std::abs(hostile(random))};
    measurements.push_back(std::move(measurement));
  }
  return measurements;
}

// What was published, as one row of numbers a record.
std::vector<std::vector<double>> published(Tracker& tracker, const std::vector<Measurement>& measurements) {
  std::vector<std::vector<double>> rows;
  for (const Measurement& measurement : measurements)
    for (const StepRecord& record : tracker.step(measurement)) {
      std::vector<double> row{static_cast<double>(record.track), static_cast<double>(record.status), record.time_s};
      row.insert(row.end(), record.x.begin(), record.x.end());
      for (const double value : record.P.reshaped()) row.push_back(value);
      rows.push_back(std::move(row));
      if (record.status == StepStatus::failed) continue;
      EXPECT_TRUE(record.x.allFinite()) << record.x.transpose();
      EXPECT_TRUE(record.P.allFinite()) << record.P;
      EXPECT_TRUE((record.P.diagonal().array() >= 0.0).all()) << record.P.diagonal().transpose();
    }
  return rows;
}

bool is_same(const std::vector<std::vector<double>>& a, const std::vector<std::vector<double>>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const auto& row_a, const auto& row_b) {
    return std::equal(row_a.begin(), row_a.end(), row_b.begin(), row_b.end(),
                      [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); });
  });
}

class HostileStreams : public ::testing::TestWithParam<std::string> {};

TEST_P(HostileStreams, BreakNoTracker) {
  const Study study = Study::load(std::string(TRUEBEARING_SOURCE_DIR "/data/studies/") + GetParam() + ".toml");
  std::size_t rows = 0;
  for (const TrackerSpec& spec : study.trackers()) {
    const std::unique_ptr<Tracker> tracker = study.make_tracker(spec.name);
    const std::optional<Measured> measured = tracker->measures();
    if (!measured) continue;
    RandomStream random({.seed = 31}, StreamId::test);
    for (int number = 0; number < kStreams; ++number) {
      SCOPED_TRACE(spec.name + ", stream " + std::to_string(number));
      const int opening = number % 20 == 0 ? kTameRows : 0;
      const auto measurements = stream(opening, static_cast<Eigen::Index>(measured->components.size()), random);
      tracker->reset();
      const auto first = published(*tracker, measurements);
      rows += first.size();
      tracker->reset();
      ASSERT_TRUE(is_same(published(*tracker, measurements), first)) << "after a reset";
      if (HasFailure()) return;
    }
  }
  EXPECT_GT(rows, 0u);
}

// What is published at the rows that hold something, of a target that is at a random place in every one of them.
TEST_P(HostileStreams, EmptyRowsLeaveNoTrace) {
  const Study study = Study::load(std::string(TRUEBEARING_SOURCE_DIR "/data/studies/") + GetParam() + ".toml");
  std::size_t rows = 0;
  for (const TrackerSpec& spec : study.trackers()) {
    const std::unique_ptr<Tracker> without = study.make_tracker(spec.name), with = without->fresh();
    const std::optional<Measured> measured = without->measures();
    if (!measured) continue;
    SCOPED_TRACE(spec.name);
    RandomStream random({.seed = 32}, StreamId::test);
    const auto n = static_cast<Eigen::Index>(measured->components.size());
    for (int k = 1; k <= kTameRows; ++k) {
      const Measurement measurement = tame(k, n, random);
      Measurement empty = measurement;
      empty.time_s += 7.0;
      empty.z.setConstant(kNaN);
      const auto expected = published(*without, {measurement});
      rows += expected.size();
      ASSERT_TRUE(is_same(published(*with, {measurement}), expected)) << "at row " << k;
      published(*with, {empty});
    }
  }
  EXPECT_GT(rows, 0u);
}

INSTANTIATE_TEST_SUITE_P(Studies, HostileStreams, ::testing::ValuesIn(studies()),
                         [](const auto& study) { return study.param; });

}  // namespace
}  // namespace truebearing::hostile_streams_test
