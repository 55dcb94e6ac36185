// SPDX-License-Identifier: Apache-2.0
#include "truebearing/array/interval.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "tests/support/array_scene.hpp"

#include "truebearing/core/constants.hpp"

namespace truebearing::interval_test {
namespace {

using testing::ArrayScene;
using testing::Snapshots;

ArrayScene noise(int sensors, int snapshots) {
  ArrayScene scene;
  scene.sensors = sensors;
  scene.snapshots = snapshots;
  return scene;
}

Snapshots draw(const ArrayScene& scene, std::uint64_t run = 0) {
  RandomStream random({1, Role::evaluation, run}, StreamId::test);
  return scene.draw(random);
}

std::size_t place(const ArrayScene& scene, int t, int m) {
  return static_cast<std::size_t>(t * scene.sensors + m);
}

// That it holds exactly these snapshots of a block, and zeros of all other rows.
void expect_holds(const Interval& interval, const ArrayScene& scene, const Snapshots& values,
                  const std::vector<int>& numbers, const std::string& what) {
  ASSERT_EQ(interval.snapshots(), static_cast<int>(numbers.size())) << what;
  for (int t = 0; t < interval.snapshots(); ++t) {
    const int number = numbers[static_cast<std::size_t>(t)];
    EXPECT_EQ(interval.number(t), number) << what;
    for (int m = 0; m < padded_to_widest(scene.sensors); ++m) {
      const bool is_heard = m < scene.sensors && interval.live()[static_cast<std::size_t>(m)] == 1.0;
      const std::complex<double> value = is_heard ? values[place(scene, number, m)] : 0.0;
      EXPECT_EQ(interval.re(t)[m], value.real()) << what << ": sensor " << m << ", snapshot " << t;
      EXPECT_EQ(interval.im(t)[m], value.imag()) << what << ": sensor " << m << ", snapshot " << t;
    }
  }
}

TEST(Interval, KeepsAWholeBlockAndPadsItsSensorsToEight) {
  EXPECT_EQ(padded_to_widest(1), 8);
  EXPECT_EQ(padded_to_widest(8), 8);
  EXPECT_EQ(padded_to_widest(9), 16);
  ArrayScene scene = noise(5, 4);
  scene.spacing_wavelengths = 0.47;
  const Snapshots values = draw(scene);
  const Interval interval = scene.interval(values);
  EXPECT_EQ(interval.sensors(), 5);
  EXPECT_EQ(interval.live_sensors(), 5);
  EXPECT_EQ(interval.live(), std::vector<double>(5, 1.0));
  EXPECT_EQ(interval.block_snapshots(), 4);
  EXPECT_EQ(interval.spacing_wavelengths(), 0.47);
  EXPECT_EQ(interval.interval_s(), 1.0);
  EXPECT_TRUE(interval.is_usable());
  expect_holds(interval, scene, values, {0, 1, 2, 3}, "whole");
  EXPECT_EQ(interval.value(2, 3), values[place(scene, 2, 3)]);
}

TEST(Interval, SensorThatGivesNothingThroughoutIsDead) {
  const ArrayScene scene = noise(5, 4);
  for (const std::complex<double> nothing : {std::complex<double>(0.0, 0.0), std::complex<double>(kNaN, 0.0),
                                             std::complex<double>(0.0, std::numeric_limits<double>::infinity())}) {
    Snapshots values = draw(scene);
    for (int t = 0; t < 4; ++t) values[place(scene, t, 1)] = nothing;
    const Interval interval = scene.interval(values);
    EXPECT_EQ(interval.live_sensors(), 4);
    EXPECT_EQ(interval.live(), (std::vector<double>{1.0, 0.0, 1.0, 1.0, 1.0}));
    EXPECT_TRUE(interval.is_usable());
    expect_holds(interval, scene, values, {0, 1, 2, 3}, "dead");
  }
}

TEST(Interval, SensorThatIsSilentForAWhileLives) {
  const ArrayScene scene = noise(5, 4);
  Snapshots values = draw(scene);
  for (int t = 0; t < 3; ++t) values[place(scene, t, 1)] = 0.0;
  const Interval interval = scene.interval(values);
  EXPECT_EQ(interval.live_sensors(), 5);
  expect_holds(interval, scene, values, {0, 1, 2, 3}, "silent");
}

TEST(Interval, SnapshotsThatMissAValueAreDroppedAndTheOthersKeepTheirNumbers) {
  const ArrayScene scene = noise(5, 6);
  Snapshots values = draw(scene);
  values[place(scene, 0, 4)] = {kNaN, 1.0};
  values[place(scene, 3, 0)] = {1.0, std::numeric_limits<double>::infinity()};
  for (int t = 0; t < 6; ++t) values[place(scene, t, 2)] = {kNaN, kNaN};  // a dead sensor drops nothing
  const Interval interval = scene.interval(values);
  EXPECT_EQ(interval.live(), (std::vector<double>{1.0, 1.0, 0.0, 1.0, 1.0}));
  EXPECT_EQ(interval.block_snapshots(), 6);
  expect_holds(interval, scene, values, {1, 2, 4, 5}, "dropped");
}

TEST(Interval, IsOfNoUseWithoutASnapshotOrWithLessThanTwoSensors) {
  const ArrayScene scene = noise(3, 2);
  Snapshots values = draw(scene);
  for (int t = 0; t < 2; ++t) values[place(scene, t, 0)] = 0.0;
  EXPECT_TRUE(scene.interval(values).is_usable());
  for (int t = 0; t < 2; ++t) values[place(scene, t, 1)] = {kNaN, kNaN};
  EXPECT_FALSE(scene.interval(values).is_usable());
  values = draw(scene);
  for (int t = 0; t < 2; ++t) values[place(scene, t, t)] = {kNaN, kNaN};
  EXPECT_FALSE(scene.interval(values).is_usable());
  EXPECT_EQ(scene.interval(values).live_sensors(), 3);
  EXPECT_FALSE(scene.interval({}).is_usable());
}

TEST(Interval, SumsTellBlocksApart) {
  const ArrayScene scene = noise(3, 2);
  const Snapshots values = draw(scene);
  std::complex<double> sum = 0.0;
  double power = 0.0;
  for (const std::complex<double> value : values) {
    sum += value;
    power += std::norm(value);
  }
  const Eigen::Vector3d sums = scene.interval(values).sums();
  EXPECT_NEAR(sums[0], sum.real(), 1e-12 * power);
  EXPECT_NEAR(sums[1], sum.imag(), 1e-12 * power);
  EXPECT_NEAR(sums[2], power, 1e-12 * power);
  Snapshots other = values;
  other[3] += 1e-9;
  EXPECT_NE(scene.interval(other).sums(), sums);
  other[3] = {kNaN, 0.0};
  EXPECT_TRUE(std::isnan(scene.interval(other).sums()[2]));
}

TEST(Interval, ForgetsWhatItHeldOfBlocksOfOtherSizes) {
  Interval interval;
  std::uint64_t run = 0;
  for (const auto& [sensors, snapshots] :
       {std::pair(16, 6), {15, 6}, {16, 2}, {13, 6}, {16, 6}, {3, 9}, {4, 1}, {2, 9}, {30, 3}, {15, 30}}) {
    const ArrayScene scene = noise(sensors, snapshots);
    Snapshots values = draw(scene, run++);
    for (const bool has_dead_sensor : {false, true}) {
      if (has_dead_sensor)
        for (int t = 0; t < snapshots; ++t) values[place(scene, t, 0)] = 0.0;
      interval.take(scene.block(values));
      std::vector<int> all;
      for (int t = 0; t < snapshots; ++t) all.push_back(t);
      ASSERT_EQ(interval.live().size(), static_cast<std::size_t>(sensors));
      EXPECT_EQ(interval.live_sensors(), sensors - (has_dead_sensor ? 1 : 0));
      expect_holds(interval, scene, values, all, std::to_string(sensors) + " sensors");
    }
  }
}

}  // namespace
}  // namespace truebearing::interval_test
