// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tma/observability.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/bearing_frequency_runs.hpp"
#include "tests/support/bearing_runs.hpp"
#include "truebearing/tma/target_motion_batch.hpp"

namespace truebearing::observability_test {
namespace {

using testing::two_legs;

// Geometries in which no number of bearings tells the range (Nardone and Aidala 1981): own ship never manoeuvres, or
// only so that the target's bearings stay those of an unaccelerated one, here along the line to a target that keeps
// its bearing. With its frequencies, and the range at the end.
struct Geometry {
  testing::BearingFrequencyWindows windows;
  double range_m = 0.0;
};
Geometry unobservable(RandomStream& stream, bool along_the_sight) {
  Geometry geometry;
  const double bearing = stream.uniform(-kPi, kPi), range_m = stream.uniform(4000.0, 15000.0);
  const double speed = stream.uniform(1.0, 10.0), course = stream.uniform(-kPi, kPi);
  const double own_speed = stream.uniform(1.0, 10.0), own_course = stream.uniform(-kPi, kPi);
  const double change_s = stream.uniform(100.0, 800.0), sprint = stream.uniform(-2.0, 2.0);
  const Eigen::Vector2d sight(std::sin(bearing), std::cos(bearing));
  Eigen::Vector2d own_mps = own_speed * Eigen::Vector2d(std::sin(own_course), std::cos(own_course));
  Eigen::Vector2d target_mps = speed * Eigen::Vector2d(std::sin(course), std::cos(course));
  if (along_the_sight) target_mps = own_mps + stream.uniform(-1.0, 1.0) * sight;  // on a constant bearing
  constexpr double kFrequency_hz = 200.0, kSigma_hz = 0.02;
  for (double t = 0.0; t <= 1000.0; t += 10.0) {
    SensorState own{t * own_mps, own_mps};
    if (along_the_sight) own.position_m += sprint * std::max(t - change_s, 0.0) * sight;
    if (along_the_sight && t > change_s) own.velocity_mps += sprint * sight;
    const Eigen::Vector2d d = range_m * sight + t * target_mps - own.position_m;
    const double v_r = d.normalized().dot(target_mps - own.velocity_mps);
    geometry.windows.bearings.add(t, wrap_pi(std::atan2(d.x(), d.y()) + radians(1.0) * stream.normal()), radians(1.0),
                                  own.position_m);
    geometry.windows.frequencies.add(t, kFrequency_hz * (1.0 - v_r / kSoundInWater_mps) + kSigma_hz * stream.normal(),
                                     kSigma_hz, own);
    geometry.range_m = d.norm();
  }
  return geometry;
}

TEST(Observability, WithoutAManoeuvreThereIsNeverAConfidentAnswer) {
  RandomStream stream({1, Role::evaluation, 0}, StreamId::test);
  TargetMotionBatch batch;
  for (int i = 0; i < 10000; ++i) {
    const BatchEstimate estimate = batch.solve(unobservable(stream, false).windows.bearings);
    ASSERT_TRUE(estimate.found);
    ASSERT_FALSE(batch.observability().observable()) << i;
    ASSERT_GT(batch.observability().log_range_sigma, 1e3) << i;
    ASSERT_TRUE(estimate.P.allFinite());
  }
}

// Noise on a constant bearing looks like a near target that hardly moves; one infinitely far away looks the same.
TEST(Observability, AManoeuvreAlongTheLineOfSightSaysNothingOfTheRange) {
  RandomStream stream({2, Role::evaluation, 0}, StreamId::test);
  TargetMotionBatch batch;
  for (int i = 0; i < 10000; ++i) {
    batch.solve(unobservable(stream, true).windows.bearings);
    EXPECT_FALSE(batch.observability().observable())
        << i << " " << batch.observability().log_range_sigma << " " << batch.observability().against_infinity;
  }
}

// The Doppler shift of a target that passes tells its range without any manoeuvre. Where that is said, it is so.
TEST(Observability, WithFrequenciesARangeThatIsSaidToBeKnownIs) {
  constexpr double kSigmas = 6.0;
  RandomStream stream({3, Role::evaluation, 0}, StreamId::test);
  TargetMotionBatch batch;
  int known = 0;
  for (int i = 0; i < 10000; ++i) {
    const Geometry geometry = unobservable(stream, false);
    const BearingWindow& bearings = geometry.windows.bearings;
    const BatchEstimate estimate = batch.solve(bearings, std::nullopt, nullptr, &geometry.windows.frequencies);
    ASSERT_TRUE(estimate.found);
    ASSERT_TRUE(estimate.P.allFinite());
    if (!batch.observability().observable()) continue;
    ++known;
    const double range_m = (estimate.x.head<2>() - bearings.site_m(bearings.size() - 1)).norm();
    ASSERT_LT(std::abs(std::log(range_m / geometry.range_m)), kSigmas * batch.observability().log_range_sigma) << i;
  }
  EXPECT_GT(known, 5000);
}

TEST(Observability, FrequenciesOnAConstantBearingSayNothingOfTheRange) {
  RandomStream stream({4, Role::evaluation, 0}, StreamId::test);
  TargetMotionBatch batch;
  for (int i = 0; i < 10000; ++i) {
    const Geometry geometry = unobservable(stream, true);
    batch.solve(geometry.windows.bearings, std::nullopt, nullptr, &geometry.windows.frequencies);
    EXPECT_FALSE(batch.observability().observable())
        << i << " " << batch.observability().log_range_sigma << " " << batch.observability().against_infinity;
  }
}

TEST(Observability, AManoeuvreAcrossTheLineOfSightMakesTheRangeKnown) {
  TargetMotionBatch batch;
  batch.solve(two_legs({3000.0, 5000.0, -2.0, 1.0}, 300.0, 900.0, 1.0));
  EXPECT_EQ(batch.observability().rank, 4);
  EXPECT_LT(batch.observability().log_range_sigma, 0.2);
}

TEST(Observability, NamesTheDirectionThatIsOpen) {
  const Eigen::Vector4d target(3000.0, 5000.0, -2.0, 1.0);
  const BearingWindow window = two_legs(target, 1e9, 900.0);
  TargetMotionBatch batch;
  const BatchEstimate estimate = batch.solve(window);
  EXPECT_EQ(batch.observability().rank, 3);
  // The target may be nearer or farther along its bearing, with a velocity relative to own ship in proportion.
  const Eigen::Vector4d open = batch.observability().worst;
  const Eigen::Vector2d offset = estimate.x.head<2>() - Eigen::Vector2d(0.0, 4500.0);
  const Eigen::Vector2d relative = estimate.x.tail<2>() - Eigen::Vector2d(0.0, 5.0);
  Eigen::Vector4d expected;
  expected << offset, relative;
  EXPECT_NEAR(std::abs(open.dot(expected)) / (open.norm() * expected.norm()), 1.0, 1e-6);
}

}  // namespace
}  // namespace truebearing::observability_test
