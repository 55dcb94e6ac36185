// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support/line_trackers.hpp"
#include "truebearing/core/chi_square.hpp"
#include "truebearing/core/constants.hpp"
#include "truebearing/core/covariance.hpp"
#include "truebearing/tracker/bearing_sensor.hpp"

namespace truebearing::filter_tracker_test {
namespace {

using testing::last_record;
using testing::position;
using testing::radar_log;
using testing::RadarFilter;
using testing::RadarTracker;

using Scalar1 = Eigen::Matrix<double, 1, 1>;

TEST(FilterTracker, PriorBelongsToItsTime) {
  const RadarFilter radar;
  KalmanFilter<2> filter = radar.filter();
  filter.predict(radar.motion(), 2.5);
  const Eigen::Vector2d predicted = filter.x();
  const auto update = filter.update(radar.sensor().model(position(2.5, 700.0)), Scalar1(700.0));

  const auto tracker = radar.tracker();
  const auto records = tracker->step(position(2.5, 700.0));
  ASSERT_EQ(records.size(), 1u);
  const StepRecord& record = records[0];
  EXPECT_EQ(record.status, StepStatus::ok);
  EXPECT_EQ(record.track, 0);
  EXPECT_EQ(record.time_s, 2.5);
  EXPECT_EQ(record.x, filter.x());
  EXPECT_EQ(record.P, filter.P());
  EXPECT_EQ(record.prediction->x, predicted);
  EXPECT_EQ(record.innovation->nu, update.nu);
  EXPECT_EQ(record.innovation->S, update.S);
  EXPECT_EQ(record.innovation->nis, update.nis);
  EXPECT_EQ(record.innovation->z[0], 700.0);
  EXPECT_EQ(*record.gain, update.K);
}

TEST(FilterTracker, PartsThatDoNotFitAreRefused) {
  const RadarFilter radar;
  const auto made = [&](const StateSpace& space, const Start& start, FilterTrackerOptions options = {}) {
    return RadarTracker(space, radar.motion(), radar.sensor(), start, options);
  };
  EXPECT_NO_THROW(made(line_space(), TwoPointStart{}));
  EXPECT_THROW(made(line_space(), PriorStart{Eigen::Vector3d::Zero(), Eigen::Matrix3d::Identity()}),
               std::invalid_argument);
  EXPECT_THROW(made(line_space(), RangePrior{}), std::invalid_argument) << "positions tell no bearing";
  EXPECT_THROW(made(plane_space(), TwoPointStart{}), std::invalid_argument) << "two states are no plane";
  using OfBearings = FilterTrackerOf<KalmanFilter<2>, testing::RadarMotion, BearingSensor>;
  EXPECT_THROW(OfBearings(line_space(), radar.motion(), BearingSensor{}, HandOverStart{}), std::invalid_argument)
      << "a bearing is of four states";
}

TEST(FilterTracker, TwoMeasurementsMakeAState) {
  RadarTracker tracker(line_space(), RadarFilter{}.motion(), {Scalar1(30.0), 1.0}, TwoPointStart{});
  EXPECT_TRUE(tracker.step(position(10.0, 100.0)).empty());
  EXPECT_TRUE(tracker.step(position(11.0, kNaN)).empty()) << "nothing to coast yet";
  const auto records = tracker.step(position(12.0, 160.0));
  ASSERT_EQ(records.size(), 1u);
  EXPECT_EQ(records[0].status, StepStatus::ok);
  EXPECT_EQ(records[0].x, Eigen::Vector2d(160.0, 30.0));
  KalmanFilter<2> still(Eigen::Vector2d::Zero(), Eigen::Matrix2d::Zero());
  still.predict(RadarFilter{}.motion(), 2.0);
  const Eigen::RowVector2d as_slope(0.5, -1.0);  // of what the target did in between, [1/dt, -1]
  Eigen::Matrix2d P;
  P << 900.0, 450.0, 450.0, 450.0 + as_slope * still.P() * as_slope.transpose();  // [R, R/dt; R/dt, 2R/dt^2], and Q
  EXPECT_LT((records[0].P - P).norm(), 1e-12 * P.norm());
  EXPECT_FALSE(records[0].innovation) << "nothing was predicted";
  EXPECT_TRUE(tracker.step(position(13.0, 190.0))[0].innovation.has_value());
}

TEST(FilterTracker, TwoMeasurementsOfOneTimeMakeNoState) {
  RadarTracker tracker(line_space(), RadarFilter{}.motion(), {Scalar1(30.0), 1.0}, TwoPointStart{});
  EXPECT_TRUE(tracker.step(position(10.0, 100.0)).empty());
  EXPECT_TRUE(tracker.step(position(10.0, 110.0)).empty());
  EXPECT_EQ(tracker.step(position(11.0, 160.0))[0].x, Eigen::Vector2d(160.0, 50.0)) << "from the later of the two";
}

TEST(FilterTracker, StepsAreAsLongAsTheTimesSay) {
  const RadarFilter radar;
  KalmanFilter<2> filter = radar.filter();
  const auto tracker = radar.tracker();
  double last_s = 0.0;
  for (const double time_s : {0.3, 0.31, 2.0, 9.5, 9.5001, 60.0}) {
    const double z = 200.0 * time_s + 17.0;
    filter.predict(radar.motion(), time_s - last_s);
    filter.update(radar.sensor().model(position(time_s, z)), Scalar1(z));
    const auto records = tracker->step(position(time_s, z));
    EXPECT_EQ(records[0].x, filter.x());
    EXPECT_EQ(records[0].P, filter.P());
    last_s = time_s;
  }
}

// Rows without a usable measurement, sprinkled over a log, must not show in the records of the other rows. Discrete
// noise is the hard case: crossing a and then b is not crossing a + b.
template <typename Noise>
void expect_no_trace_of_missing(const Noise& noise, const FilterTrackerOptions& options) {
  using Motion = ConstantVelocity<1, Noise>;
  FilterTrackerOf<KalmanFilter<2>, Motion, PositionSensor<1>> tracker(
      line_space(), Motion{noise}, RadarFilter{}.sensor(),
      PriorStart{Eigen::Vector2d::Zero(), Eigen::Vector2d(1e6, 5e4).asDiagonal().toDenseMatrix()}, options);
  const auto clean = tracker.fresh();
  RandomStream random({}, StreamId::test);
  int missing = 0;
  for (const Measurement& measurement : radar_log(3, 200)) {
    for (double before_s = 0.9; before_s > 0.1 && random.uniform() < 0.4; before_s *= 0.5) {
      Measurement bad = position(measurement.time_s - before_s, random.uniform() < 0.5 ? kNaN : kInfinity);
      if (random.uniform() < 0.3) bad.z.resize(0);
      const auto records = tracker.step(bad);
      ++missing;
      ASSERT_EQ(records.size(), 1u);
      EXPECT_EQ(records[0].status, StepStatus::coasted);
      EXPECT_EQ(records[0].time_s, bad.time_s);
      EXPECT_FALSE(records[0].innovation || records[0].gain) << "absent is absent";
      EXPECT_TRUE(is_covariance(records[0].P));
    }
    const auto with = tracker.step(measurement);
    const auto without = clean->step(measurement);
    ASSERT_EQ(with[0].x, without[0].x);
    ASSERT_EQ(with[0].P, without[0].P);
    ASSERT_EQ(with[0].status, without[0].status);
  }
  EXPECT_GT(missing, 50);
  EXPECT_EQ(tracker.counts().missing, missing);
  EXPECT_EQ(tracker.counts().gated, clean->counts().gated);
}

TEST(FilterTracker, MissingMeasurementLeavesNoTrace) {
  expect_no_trace_of_missing(FixedNoise<2>{Eigen::Vector2d(5.0, 0.1).asDiagonal(), 1.0}, {});
  expect_no_trace_of_missing(DiscreteWhiteNoise{1.5}, {});
  expect_no_trace_of_missing(ContinuousWhiteNoise{0.5}, {});
  expect_no_trace_of_missing(DiscreteWhiteNoise{1.5}, {.gate_nis = 2.0, .lost_after_s = 3.0});
}

TEST(FilterTracker, CoastedStateIsThePrediction) {
  const RadarFilter radar;
  const auto tracker = radar.tracker();
  const StepRecord before = last_record(*tracker, radar_log(1, 20));
  const auto records = tracker->step(position(before.time_s + 4.0, kNaN));
  const Eigen::Matrix2d F = radar.motion().F(4.0);
  EXPECT_LT((records[0].x - F * before.x).norm(), 1e-12 * before.x.norm());
  EXPECT_LT((records[0].P - F * before.P * F.transpose() - radar.motion().Q(4.0)).norm(), 1e-12 * records[0].P.norm());
  EXPECT_EQ(records[0].prediction->x, records[0].x);
}

TEST(FilterTracker, MeasurementsOfOneTimeAreBothFused) {
  const RadarFilter radar;
  KalmanFilter<2> filter = radar.filter();
  filter.predict(radar.motion(), 1.0);
  for (const double z : {100.0, 300.0}) filter.update(radar.sensor().model(position(1.0, z)), Scalar1(z));
  const auto tracker = radar.tracker();
  tracker->step(position(1.0, 100.0));
  const auto records = tracker->step(position(1.0, 300.0));
  EXPECT_EQ(records[0].status, StepStatus::ok);
  EXPECT_EQ(records[0].x, filter.x());
  EXPECT_EQ(records[0].P, filter.P());
  EXPECT_EQ(tracker->counts().repeated, 0);
}

TEST(FilterTracker, IdenticalMeasurementIsUsedOnceAndCounted) {
  const RadarFilter radar;
  const auto tracker = radar.tracker();
  const auto clean = radar.tracker();
  int repeated = 0;
  for (const Measurement& measurement : radar_log(5, 50)) {
    const StepRecord first = tracker->step(measurement)[0];
    clean->step(measurement);
    const auto again = tracker->step(measurement);
    ++repeated;
    ASSERT_EQ(again.size(), 1u);
    EXPECT_EQ(again[0].status, StepStatus::rejected);
    EXPECT_FALSE(again[0].innovation || again[0].gain);
    EXPECT_EQ(again[0].x, first.x);
    EXPECT_EQ(again[0].P, first.P);
  }
  EXPECT_EQ(tracker->counts().repeated, repeated);
  EXPECT_EQ(tracker->step(position(51.0, 9.0))[0].x, clean->step(position(51.0, 9.0))[0].x);
}

TEST(FilterTracker, LateMeasurementIsIgnoredAndCounted) {
  const RadarFilter radar;
  const auto tracker = radar.tracker();
  const auto clean = radar.tracker();
  const StepRecord before = last_record(*tracker, radar_log(5, 50));
  last_record(*clean, radar_log(5, 50));
  for (const double time_s : {49.5, -1e9, kNaN, kInfinity}) {
    const auto records = tracker->step(position(time_s, 1e6));
    ASSERT_EQ(records.size(), 1u);
    EXPECT_EQ(records[0].status, StepStatus::rejected);
    EXPECT_EQ(records[0].x, before.x);
    EXPECT_EQ(records[0].time_s, before.time_s);
  }
  EXPECT_EQ(tracker->counts().out_of_order, 4);
  EXPECT_EQ(tracker->step(position(51.0, 9.0))[0].x, clean->step(position(51.0, 9.0))[0].x);
}

TEST(FilterTracker, MeasurementOfAnotherSizeIsCoasted) {
  const auto tracker = RadarFilter{}.tracker();
  tracker->step(position(1.0, 10.0));
  Measurement plane = position(2.0, 1.0);
  plane.z = BoundedVector::Constant(2, 1.0);
  EXPECT_EQ(tracker->step(plane)[0].status, StepStatus::coasted);
}

TEST(FilterTracker, GateRejectsAnOutlierAndPredicts) {
  RadarFilter radar;
  radar.variance = {1e6, 5e4};
  radar.options.gate_nis = chi_square_quantile(0.999, 1);
  const auto tracker = radar.tracker();
  const auto clean = radar.tracker();
  for (const Measurement& measurement : radar_log(8, 60)) {
    tracker->step(measurement);
    clean->step(measurement);
  }
  const int gated = tracker->counts().gated;
  const StepRecord outlier = tracker->step(position(61.0, 1e6))[0];
  const StepRecord coasted = clean->step(position(61.0, kNaN))[0];
  EXPECT_EQ(outlier.status, StepStatus::rejected);
  EXPECT_EQ(outlier.x, coasted.x);
  EXPECT_EQ(outlier.P, coasted.P);
  ASSERT_TRUE(outlier.innovation.has_value()) << "for the whoever wants to know why";
  EXPECT_GT(outlier.innovation->nis, radar.options.gate_nis);
  EXPECT_FALSE(outlier.gain.has_value());
  EXPECT_EQ(tracker->counts().gated, gated + 1);
  const double z = outlier.x[0];
  EXPECT_EQ(tracker->step(position(62.0, z))[0].x, clean->step(position(62.0, z))[0].x) << "and leaves no trace";
}

TEST(FilterTracker, TargetThatJumpedIsFoundAgain) {
  RadarFilter radar;
  radar.sigma_m = 10.0;
  radar.options.gate_nis = chi_square_quantile(0.999, 1);
  const auto tracker = radar.tracker();
  for (int k = 1; k <= 50; ++k) tracker->step(position(k, 10.0 * k));
  int misses = 0;
  StepRecord record;
  for (int k = 51; k <= 100; ++k) {  // 2 km away from one step to the next, and then on as before
    record = tracker->step(position(k, 2000.0 + 10.0 * k))[0];
    if (record.status == StepStatus::rejected) ++misses;
  }
  EXPECT_GE(misses, 2) << "one that is off is an outlier";
  EXPECT_LE(misses, 10) << "as promised";
  EXPECT_EQ(record.status, StepStatus::ok);
  EXPECT_NEAR(record.x[0], 3000.0, 100.0);
  EXPECT_EQ(tracker->counts().gated, misses);
  EXPECT_EQ(record.track, 0) << "the same track";
}

// The first of the two points that begin a track is `off_m` away from all that come after: how far, at last, a gated
// track is from one that began with good ones.
double remains_of_a_wrong_start(double off_m, int steps) {
  const auto tracker_with_gate = [] {
    return RadarTracker(line_space(), RadarFilter{}.motion(), {Scalar1(30.0), 1.0}, TwoPointStart{},
                        {.gate_nis = chi_square_quantile(0.9999, 1)});
  };
  RadarTracker clean = tracker_with_gate(), wrong = tracker_with_gate();
  RandomStream random({.seed = 9}, StreamId::test);
  double difference_m = kInfinity;
  for (int k = 0; k < steps; ++k) {
    const double z = 20.0 * k + 30.0 * random.normal();
    const auto a = clean.step(position(k, z)), b = wrong.step(position(k, k == 0 ? z + off_m : z));
    if (!a.empty() && !b.empty()) difference_m = std::abs(a[0].x[0] - b[0].x[0]);
  }
  return difference_m;
}

TEST(FilterTracker, WrongFirstPositionIsForgottenAfterAFewGoodOnes) {
  for (const double off_m : {3e3, 1e4, 5e4, 1e6}) EXPECT_LT(remains_of_a_wrong_start(off_m, 20), 15.0) << off_m;
}

TEST(FilterTracker, FirstOfTwoPositionsExpires) {
  RadarTracker tracker(line_space(), RadarFilter{}.motion(), {Scalar1(30.0), 1.0}, TwoPointStart{},
                       {.lost_after_s = 5.0});
  EXPECT_TRUE(tracker.step(position(0.0, 0.0)).empty());
  EXPECT_TRUE(tracker.step(position(3600.0, 1000.0)).empty()) << "a target would have been lost long ago";
  EXPECT_EQ(tracker.step(position(3601.0, 1020.0))[0].x, Eigen::Vector2d(1020.0, 20.0));
}

TEST(FilterTracker, TrackBeyondAllSenseIsFailedAndBegunAfresh) {
  RadarTracker tracker(line_space(), RadarFilter{}.motion(), {Scalar1(30.0), 1.0}, TwoPointStart{});
  tracker.step(position(0.0, 0.0));
  tracker.step(position(1.0, 10.0));
  const StepRecord lost = tracker.step(position(1e12, kNaN))[0];
  EXPECT_EQ(lost.status, StepStatus::failed);
  EXPECT_EQ(lost.x, Eigen::Vector2d(10.0, 10.0)) << "as it last was";
  EXPECT_LT(lost.P(0, 0), 1e4);
  EXPECT_EQ(tracker.counts().failed, 1);
  EXPECT_TRUE(tracker.step(position(1e12 + 1.0, 70.0)).empty());
  const StepRecord fresh = tracker.step(position(1e12 + 2.0, 80.0))[0];
  EXPECT_EQ(fresh.track, 1);
  EXPECT_EQ(fresh.x, Eigen::Vector2d(80.0, 10.0));
}

TEST(FilterTracker, LongGapEndsTheTrackAndTheNextMeasurementBeginsOne) {
  RadarFilter radar;
  radar.options.lost_after_s = 10.0;
  const auto tracker = radar.tracker();
  last_record(*tracker, radar_log(5, 50));
  EXPECT_EQ(tracker->step(position(60.0, 100.0))[0].track, 0) << "10 s are not too long";
  const auto records = tracker->step(position(70.1, 100.0));
  ASSERT_EQ(records.size(), 1u);
  EXPECT_EQ(records[0].track, 1);
  KalmanFilter<2> filter = radar.filter();  // its prior, now
  filter.update(radar.sensor().model(position(0.0, 100.0)), Scalar1(100.0));
  EXPECT_EQ(records[0].x, filter.x());
  EXPECT_EQ(records[0].P, filter.P());
}

TEST(FilterTracker, LostTargetNeedsTwoMeasurementsAgainWhereTwoMadeIt) {
  RadarTracker tracker(line_space(), RadarFilter{}.motion(), {Scalar1(30.0), 1.0}, TwoPointStart{},
                       {.lost_after_s = 5.0});
  tracker.step(position(0.0, 0.0));
  EXPECT_EQ(tracker.step(position(1.0, 10.0))[0].track, 0);
  EXPECT_TRUE(tracker.step(position(7.0, 1000.0)).empty());
  const auto records = tracker.step(position(8.0, 1020.0));
  ASSERT_EQ(records.size(), 1u);
  EXPECT_EQ(records[0].track, 1);
  EXPECT_EQ(records[0].x, Eigen::Vector2d(1020.0, 20.0));
}

TEST(FilterTracker, CovarianceOfALostTargetStopsGrowing) {
  RadarFilter radar;
  radar.options.lost_after_s = 10.0;
  const auto tracker = radar.tracker();
  const StepRecord last = last_record(*tracker, radar_log(5, 50));
  const BoundedMatrix at_5 = tracker->step(position(55.0, kNaN))[0].P;
  const BoundedMatrix at_10 = tracker->step(position(60.0, kNaN))[0].P;
  EXPECT_GT(at_5(0, 0), last.P(0, 0));
  EXPECT_GT(at_10(0, 0), at_5(0, 0));
  for (const double time_s : {61.0, 1e4, 1e12, 1e300}) {
    const auto records = tracker->step(position(time_s, kNaN));
    EXPECT_EQ(records[0].status, StepStatus::coasted);
    EXPECT_EQ(records[0].time_s, time_s);
    EXPECT_EQ(records[0].P, at_10);
  }
}

TEST(FilterTracker, FailedUpdateLeavesThePredictionAndTheLastValidState) {
  const RadarFilter radar;
  const auto tracker = radar.tracker();
  const auto clean = radar.tracker();
  last_record(*tracker, radar_log(5, 50));
  last_record(*clean, radar_log(5, 50));
  int failed = 0;
  for (const double sigma : {kNaN, 1e300}) {
    Measurement bad = position(51.0 + failed, 100.0);
    bad.sigma = BoundedVector::Constant(1, sigma);  // R is no covariance
    const auto records = tracker->step(bad);
    EXPECT_EQ(records[0].status, StepStatus::failed);
    EXPECT_TRUE(records[0].x.allFinite());
    EXPECT_TRUE(is_covariance(records[0].P));
    EXPECT_EQ(tracker->counts().failed, ++failed);
  }
  EXPECT_EQ(tracker->step(position(55.0, 9.0))[0].x, clean->step(position(55.0, 9.0))[0].x);
}

TEST(FilterTracker, FailedPredictionIsNotTakenForAState) {
  // The gap is so long that the covariance overflows: neither the old state nor anything made from it holds at that
  // time.
  const RadarFilter radar;
  const auto tracker = radar.tracker();
  const StepRecord last = last_record(*tracker, radar_log(5, 50));
  for (const double z : {100.0, kNaN}) {
    const auto records = tracker->step(position(1e200, z));
    EXPECT_EQ(records[0].status, StepStatus::failed);
    EXPECT_EQ(records[0].x, last.x);
    EXPECT_EQ(records[0].P, last.P);
    EXPECT_FALSE(records[0].innovation || records[0].prediction);
  }
  EXPECT_EQ(tracker->counts().failed, 2);
}

TEST(FilterTracker, HostileStreamNeverGivesAnInvalidRecord) {
  RandomStream random({.seed = 99}, StreamId::test);
  const std::array<double, 9> values{kNaN, kInfinity, -kInfinity, 1e308, -1e308, 0.0, 1e-308, 100.0, -5e7};
  const std::array<double, 6> sigmas{kNaN, kInfinity, 0.0, -1.0, 1e-300, 1e200};
  for (const double gate : {9.0, kInfinity}) {
    for (const double lost_after_s : {10.0, kInfinity}) {
      RadarFilter radar;
      radar.options = {gate, lost_after_s};
      const auto tracker = radar.tracker();
      double time_s = 0.0;
      for (int k = 0; k < 20000; ++k) {
        const double kind = random.uniform();
        time_s += kind < 0.02 ? random.uniform(-1e3, 1e3) : kind < 0.3 ? 0.0 : 1.0;
        Measurement measurement = position(kind > 0.999 ? kNaN : time_s, values[random.index(values.size())]);
        if (random.uniform() < 0.3) measurement.z[0] = 200.0 * k + 3000.0 * random.normal();
        if (random.uniform() < 0.1) measurement.sigma = BoundedVector::Constant(1, sigmas[random.index(sigmas.size())]);
        for (const StepRecord& record : tracker->step(measurement)) {
          ASSERT_TRUE(record.x.allFinite()) << k;
          ASSERT_TRUE(is_covariance(record.P)) << k << "\n" << record.P;
          ASSERT_TRUE(std::isfinite(record.time_s));
          ASSERT_TRUE(!record.innovation || std::isfinite(record.innovation->nis)) << k;
        }
      }
    }
  }
}

TEST(FilterTracker, ResetAndFreshBeginAnew) {
  RadarFilter radar;
  radar.options = {.gate_nis = 4.0, .lost_after_s = 5.0};
  const auto tracker = radar.tracker();
  last_record(*tracker, radar_log(5, 50));
  tracker->step(position(90.0, kNaN));
  tracker->step(position(91.0, 1e7));
  const auto copy = tracker->fresh();
  tracker->reset();
  const auto fresh = radar.tracker();
  for (const Measurement& measurement : radar_log(6, 50)) {
    const StepRecord record = fresh->step(measurement)[0];
    for (Tracker* other : {static_cast<Tracker*>(tracker.get()), copy.get()}) {
      const StepRecord same = other->step(measurement)[0];
      ASSERT_EQ(same.x, record.x);
      ASSERT_EQ(same.P, record.P);
      ASSERT_EQ(same.track, 0);
    }
  }
  EXPECT_EQ(tracker->counts().missing, 0);
  EXPECT_EQ(copy->counts().gated, fresh->counts().gated);
}

}  // namespace
}  // namespace truebearing::filter_tracker_test
