// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tracker/bearing_frequency_sensor.hpp"

#include <gtest/gtest.h>

#include "tests/support/bearing_trackers.hpp"
#include "tests/support/frequency_runs.hpp"
#include "truebearing/filter/modified_gain.hpp"
#include "truebearing/filter/unscented.hpp"
#include "truebearing/motion/constant_acceleration.hpp"

namespace truebearing::bearing_frequency_tracker_test {
namespace {

using testing::frequency_run;
using testing::FrequencyMotion;
using testing::guessed_range;
using testing::kFrequencySensor;

template <typename Filter>
using FrequencyTracker = FilterTrackerOf<Filter, FrequencyMotion, BearingFrequencySensor>;

template <typename Filter>
FrequencyTracker<Filter> tracker_of() {
  return {plane_frequency_space(), FrequencyMotion{{{1e-6}}}, kFrequencySensor, guessed_range()};
}

Measurement without_frequency(Measurement measurement) {
  measurement.z[1] = std::nan("");
  return measurement;
}

TEST(BearingFrequencySensor, TakesWhatTheMeasurementHas) {
  Measurement m;
  m.z = Eigen::Vector2d(0.3, 99.0);
  m.sigma = Eigen::Vector2d(0.01, 0.5);
  m.sensor = SensorState{{1.0, 2.0}, {3.0, 4.0}};
  const BearingFrequencySensor sensor{0.02, 0.1, 2.0};
  EXPECT_TRUE(sensor.has_value(m));
  EXPECT_DOUBLE_EQ(sensor.model(m).sigma_rad, 0.02);
  EXPECT_DOUBLE_EQ(sensor.model(m).sigma_hz, 1.0);
  EXPECT_EQ(sensor.model(m).site_velocity_mps, Eigen::Vector2d(3.0, 4.0));
  EXPECT_TRUE(sensor.has_value(without_frequency(m)));
  EXPECT_FALSE(sensor.model(without_frequency(m)).has_frequency);
  for (const double impossible_hz : {0.0, -99.0}) {
    m.z[1] = impossible_hz;
    EXPECT_FALSE(sensor.model(m).has_frequency) << impossible_hz;
    EXPECT_TRUE(std::isnan(sensor.value(m)(1))) << impossible_hz;
  }
  m.z = BoundedVector::Constant(1, 0.3);
  m.sigma.resize(0);
  EXPECT_TRUE(sensor.has_value(m));
  EXPECT_FALSE(sensor.model(m).has_frequency);
  EXPECT_DOUBLE_EQ(sensor.model(m).sigma_rad, 0.04);
  m.z[0] = std::nan("");
  EXPECT_FALSE(sensor.has_value(m));
}

// f0 = f (1 + v_r / c): as the velocity errs, so does f0.
TEST(BearingFrequencySensor, BelievesTheFrequencyThatGoesWithTheVelocity) {
  Measurement m;
  m.z = Eigen::Vector2d(0.0, 100.0);  // due North
  m.sensor = SensorState{{0.0, 0.0}, {0.0, 3.0}};
  const GaussianState plane{Eigen::Vector4d(0.0, 5000.0, 1.0, 18.0), Eigen::Vector4d(1e4, 1e6, 9.0, 16.0).asDiagonal()};
  const BearingFrequencySensor sensor{0.02, 0.1};
  const auto start = sensor.believe(plane, m);
  ASSERT_TRUE(start);
  EXPECT_DOUBLE_EQ(start->x[4], 101.0);
  EXPECT_DOUBLE_EQ(start->P(4, 4), 0.01 + 16.0 / 225.0);
  EXPECT_DOUBLE_EQ(start->P(4, 3), 16.0 / 15.0);
  EXPECT_EQ(start->P(4, 2), 0.0);
  EXPECT_FALSE(sensor.believe(plane, without_frequency(m)));
}

template <typename Filter, typename Plain>
void expect_the_bearing_alone_to_do_what_it_does_in_the_plane() {
  FrequencyTracker<Filter> with = tracker_of<Filter>();
  testing::BearingTracker<Plain> plane(plane_space(), testing::BearingMotion{{1e-6}}, BearingSensor{radians(1.0), 1.0},
                                       guessed_range());
  const Recording recording = frequency_run(1);
  for (std::size_t k = 0; k < recording.measurements.size(); ++k) {
    Measurement bearing = recording.measurements[k];
    bearing.z.conservativeResize(1);
    bearing.sigma.conservativeResize(1);
    // The first one must tell the frequency, which says nothing of the velocity by itself.
    const auto a = with.step(k == 0 ? recording.measurements[0] : without_frequency(recording.measurements[k]));
    const auto b = plane.step(bearing);
    ASSERT_EQ(a.size(), 1u);
    ASSERT_EQ(b.size(), 1u);
    EXPECT_LT((a[0].x.template head<4>() - b[0].x).norm(), 1e-6 * b[0].x.norm()) << k;
    if (k == 0) continue;
    EXPECT_NEAR(a[0].innovation->nis, b[0].innovation->nis, 1e-6 * (1.0 + b[0].innovation->nis));
    EXPECT_TRUE(std::isnan(a[0].innovation->z[1]));
  }
}

TEST(BearingFrequencyTracker, WithoutFrequenciesIsATrackerOfBearings) {
  expect_the_bearing_alone_to_do_what_it_does_in_the_plane<KalmanFilter<5>, KalmanFilter<4>>();
  expect_the_bearing_alone_to_do_what_it_does_in_the_plane<ModifiedGainFilter<5>, ModifiedGainFilter<4>>();
}

TEST(BearingFrequencyTracker, FindsTheTargetSoonerThanByItsBearings) {
  FrequencyTracker<UnscentedKalmanFilter<5>> with = tracker_of<UnscentedKalmanFilter<5>>();
  testing::BearingTracker<UnscentedKalmanFilter<4>> plane(plane_space(), testing::BearingMotion{{1e-6}},
                                                          BearingSensor{radians(1.0), 1.0}, guessed_range());
  double squares_with = 0.0, squares_plane = 0.0;
  for (std::uint64_t run = 0; run < 20; ++run) {
    with.reset();
    plane.reset();
    const Recording recording = frequency_run(run);
    for (const Measurement& measurement : recording.measurements) {
      Measurement bearing = measurement;
      bearing.z.conservativeResize(1);
      bearing.sigma.conservativeResize(1);
      const Eigen::Vector2d truth_m = recording.truth[0].x.back().head<2>();
      const auto a = with.step(measurement), b = plane.step(bearing);
      if (measurement.time_s < recording.measurements.back().time_s) continue;
      squares_with += (a[0].x.head<2>() - truth_m).squaredNorm();
      squares_plane += (b[0].x.head<2>() - truth_m).squaredNorm();
    }
  }
  EXPECT_LT(squares_with, 0.5 * squares_plane);
}

TEST(BearingFrequencyTracker, LeavesTheFrequencyOutOfRecordsInThePlane) {
  FrequencyTracker<KalmanFilter<5>> whole = tracker_of<KalmanFilter<5>>();
  FrequencyTracker<KalmanFilter<5>> cut(plane_space(), FrequencyMotion{{{1e-6}}}, kFrequencySensor, guessed_range());
  const Recording recording = frequency_run(2);
  for (const Measurement& measurement : recording.measurements) {
    const auto a = whole.step(measurement), b = cut.step(measurement);
    ASSERT_EQ(b.size(), 1u);
    EXPECT_EQ(b[0].x, a[0].x.head<4>());
    EXPECT_EQ(b[0].P, (a[0].P.topLeftCorner<4, 4>()));
  }
}

TEST(BearingFrequencyTracker, UsesWhatAMeasurementHasAndCountsWhatHasNothing) {
  FrequencyTracker<KalmanFilter<5>> tracker = tracker_of<KalmanFilter<5>>();
  const Recording recording = frequency_run(3);
  for (std::size_t k = 0; k < 30; ++k) tracker.step(recording.measurements[k]);
  Measurement frequency = recording.measurements[30];
  frequency.z[0] = std::nan("");
  EXPECT_EQ(tracker.step(frequency)[0].status, StepStatus::ok);
  EXPECT_EQ(tracker.step(without_frequency(recording.measurements[31]))[0].status, StepStatus::ok);
  EXPECT_EQ(tracker.step(without_frequency(recording.measurements[31]))[0].status, StepStatus::rejected);
  Measurement nothing = recording.measurements[32];
  nothing.z.setConstant(std::nan(""));
  EXPECT_EQ(tracker.step(nothing)[0].status, StepStatus::coasted);
  EXPECT_EQ(tracker.counts().missing, 1);
  EXPECT_EQ(tracker.counts().repeated, 1);
}

TEST(BearingFrequencyTracker, TakesOverWhereAnotherEnds) {
  FrequencyTracker<KalmanFilter<5>> before = tracker_of<KalmanFilter<5>>();
  FrequencyTracker<KalmanFilter<5>> after(plane_frequency_space(), FrequencyMotion{{{1e-6}}}, kFrequencySensor,
                                          HandOverStart{});
  const Recording recording = frequency_run(4);
  for (std::size_t k = 0; k < recording.measurements.size(); ++k) {
    const auto a = before.step(recording.measurements[k]);
    const auto b = k > 40 ? after.step(recording.measurements[k]) : std::span<const StepRecord>();
    if (k < 40) {
      EXPECT_TRUE(after.step(recording.measurements[k]).empty());
    }
    if (k == 40) after.take_over(recording.measurements[k].time_s, a[0].x, a[0].P);
    if (k <= 40) continue;
    ASSERT_EQ(b.size(), 1u);
    EXPECT_EQ(b[0].x, a[0].x);
    EXPECT_EQ(b[0].P, a[0].P);
  }
}

TEST(BearingFrequencyTracker, OfSevenStatesBeginsWithoutAcceleration) {
  using Motion = WithFrequency<ConstantAcceleration<2>>;
  FilterTrackerOf<ModifiedGainFilter<7>, Motion, BearingFrequencySensor> tracker(
      plane_frequency_space(), Motion{{{1e-12}}}, kFrequencySensor, HandOverStart{1e-3});
  tracker.take_over(0.0, Eigen::Vector<double, 5>(1000.0, 2000.0, 3.0, 4.0, 100.0),
                    Eigen::Matrix<double, 5, 5>::Identity());
  Measurement nothing;
  nothing.time_s = 100.0;
  const auto records = tracker.step(nothing);
  ASSERT_EQ(records.size(), 1u);
  EXPECT_TRUE(records[0].x.isApprox(Eigen::Vector<double, 5>(1300.0, 2400.0, 3.0, 4.0, 100.0)));
  EXPECT_NEAR(records[0].P(2, 2), 1.0 + 1e-2, 1e-3);  // 1e-3 m/s^2 over 100 s
}

}  // namespace
}  // namespace truebearing::bearing_frequency_tracker_test
