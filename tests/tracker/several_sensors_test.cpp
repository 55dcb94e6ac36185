// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tracker/several_sensors.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <utility>
#include <vector>

#include "truebearing/core/angle.hpp"
#include "truebearing/core/chi_square.hpp"
#include "truebearing/filter/filter_kinds.hpp"
#include "truebearing/filter/kalman.hpp"
#include "truebearing/filter/erased_motion.hpp"
#include "truebearing/measurement/longer_state.hpp"
#include "truebearing/motion/constant_velocity.hpp"
#include "truebearing/tracker/biased_sensor.hpp"
#include "truebearing/tracker/filter_tracker.hpp"
#include "truebearing/tracker/position_sensor.hpp"
#include "truebearing/tracker/range_bearing_rate_sensor.hpp"

namespace truebearing::several_sensors_test {
namespace {

using Motion = ConstantVelocity<2, DiscreteWhiteNoise>;
const Motion kMotion{{3.0}};
const PositionSensor<2> kLaser{{0.15, 0.15}};
const RangeBearingRateSensor kRadar{{0.3, 0.03, 0.3}};
constexpr int kOfLaser = 0, kOfRadar = 1;

std::vector<SeveralSensors::Part> laser_and_radar(bool uses_radar = true) {
  std::vector<SeveralSensors::Part> parts;
  parts.push_back({"laser", sensor_of(kLaser)});
  parts.push_back({"radar", sensor_of(kRadar), uses_radar});
  return parts;
}

std::unique_ptr<FilterTracker> tracker(std::unique_ptr<AnySensor> sensor, FilterTrackerOptions options = {}) {
  return std::make_unique<FilterTracker>(plane_space(), make_filter_state(FilterKind::kalman, erased(kMotion)),
                                         std::move(sensor), OnePointStart{10.0}, options);
}

Measurement by_laser(double time_s, double east_m, double north_m) {
  return {.time_s = time_s, .z = Eigen::Vector2d(east_m, north_m), .sigma = {}, .sensor = {}, .source = kOfLaser};
}

Measurement by_radar(double time_s, const Eigen::Vector3d& z) {
  return {.time_s = time_s, .z = z, .sigma = {}, .sensor = {}, .source = kOfRadar};
}

TEST(SeveralSensors, EachMeasurementIsTakenByItsOwnSensorsModel) {
  const auto both = tracker(std::make_unique<SeveralSensors>(laser_and_radar()));
  const Eigen::Vector3d polar(5.2, 0.6, 1.1);
  both->step(by_laser(0.0, 3.0, 4.0));
  both->step(by_radar(0.05, polar));
  const StepRecord record = both->step(by_laser(0.1, 3.1, 4.2))[0];

  KalmanFilter<4> by_hand(Eigen::Vector4d(3.0, 4.0, 0.0, 0.0),
                          Eigen::Vector4d(0.15 * 0.15, 0.15 * 0.15, 100.0, 100.0).asDiagonal());
  by_hand.predict(kMotion, 0.05);
  by_hand.update(RangeBearingRate<>{{0.0, 0.0}, {0.0, 0.0}, 0.3, 0.03, 0.3}, polar);
  by_hand.predict(kMotion, 0.1 - 0.05);
  by_hand.update(on_state<4>(Position<2>{{0.15, 0.15}}), Eigen::Vector2d(3.1, 4.2));
  EXPECT_LT((record.x - by_hand.x()).norm(), 1e-12);
  EXPECT_LT((record.P - by_hand.P()).norm(), 1e-12);
}

TEST(SeveralSensors, RecordsSayWhoMeasuredAndInnovationsAreAsLongAsItsMeasurement) {
  const auto both = tracker(std::make_unique<SeveralSensors>(laser_and_radar()));
  EXPECT_EQ(both->step(by_laser(0.0, 3.0, 4.0))[0].source, kOfLaser);
  const StepRecord second = both->step(by_radar(0.05, {5.0, 0.64, 0.0}))[0];
  EXPECT_EQ(second.source, kOfRadar);
  EXPECT_EQ(second.innovation->nu.size(), 3);
  EXPECT_EQ(second.gain->cols(), 3);
  EXPECT_EQ(both->step(by_laser(0.1, 3.0, 4.0))[0].innovation->nu.size(), 2);
}

TEST(SeveralSensors, OneThatIsNotUsedIsMissing) {
  const auto laser_alone = tracker(std::make_unique<SeveralSensors>(laser_and_radar(false)));
  laser_alone->step(by_laser(0.0, 3.0, 4.0));
  EXPECT_EQ(laser_alone->step(by_radar(0.05, {5.0, 0.64, 0.0}))[0].status, StepStatus::coasted);
  EXPECT_EQ(laser_alone->counts().missing, 1);
  Measurement unknown = by_laser(0.1, 3.0, 4.0);
  unknown.source = 7;
  EXPECT_EQ(laser_alone->step(unknown)[0].status, StepStatus::coasted);
}

TEST(SeveralSensors, ATrackBeginsWithASensorThatTellsAPosition) {
  std::vector<SeveralSensors::Part> parts = laser_and_radar();
  const auto two_point = std::make_unique<FilterTracker>(
      plane_space(), make_filter_state(FilterKind::kalman, erased(kMotion)),
      std::make_unique<SeveralSensors>(std::move(parts)), TwoPointStart{}, FilterTrackerOptions{});
  EXPECT_TRUE(two_point->step(by_radar(0.0, {5.0, 0.0, 0.0})).empty());
  const StepRecord begun = two_point->step(by_laser(1.0, 0.0, 6.0))[0];
  EXPECT_NEAR(begun.x[1], 6.0, 1e-12);
  EXPECT_NEAR(begun.x[3], 1.0, 4e-3);  // the radar's position is converted without bias
}

TEST(SeveralSensors, ASensorThatGoesWrongOpensNoGateButItsOwn) {
  FilterTrackerOptions options;
  options.gate_nis_of = {chi_square_quantile(0.999, 2.0), chi_square_quantile(0.999, 3.0)};
  const auto both = tracker(std::make_unique<SeveralSensors>(laser_and_radar()), options);
  double time_s = 0.0;
  for (int k = 0; k < 20; ++k, time_s += 0.1) {
    both->step(by_laser(time_s, 3.0, 4.0));
    both->step(by_radar(time_s + 0.05, {5.0, radians(36.87), 0.0}));
  }
  for (int k = 0; k < 2; ++k, time_s += 0.1) {  // not so often that they are believed
    both->step(by_laser(time_s, 3.0, 4.0));
    EXPECT_EQ(both->step(by_radar(time_s + 0.05, {40.0 + 30.0 * k, 2.0 - k, 0.0}))[0].status, StepStatus::rejected);
  }
  // As far off as the radar's gate, wider by now, would let pass.
  const StepRecord off = both->step(by_laser(time_s, 3.9, 4.0))[0];
  ASSERT_GT(off.innovation->nis, options.gate_nis_of[0]);
  ASSERT_LT(off.innovation->nis, 9.0 * options.gate_nis_of[0]);
  EXPECT_EQ(off.status, StepStatus::rejected);
}

TEST(SeveralSensors, WhatIsKnownOfABiasIsTakenOff) {
  std::vector<SeveralSensors::Part> parts;
  parts.push_back({"laser", sensor_of(kLaser)});
  parts.push_back({"radar", std::make_unique<BiasedSensor>(sensor_of(kRadar), Eigen::Vector3d(1.0, 0.1, -0.2))});
  const auto biased = tracker(std::make_unique<SeveralSensors>(std::move(parts)));
  const auto plain = tracker(std::make_unique<SeveralSensors>(laser_and_radar()));
  for (Tracker* one : {static_cast<Tracker*>(biased.get()), static_cast<Tracker*>(plain.get())})
    one->step(by_laser(0.0, 3.0, 4.0));
  const StepRecord mended = biased->step(by_radar(0.05, {6.0, 0.74, 0.3}))[0];
  const StepRecord wanted = plain->step(by_radar(0.05, {5.0, 0.64, 0.5}))[0];
  EXPECT_LT((mended.x - wanted.x).norm(), 1e-12);
  EXPECT_THROW(BiasedSensor(sensor_of(kRadar), Eigen::Vector2d(1.0, 0.1)), std::invalid_argument);
}

TEST(SeveralSensors, TheSameValuesAtOneTimeByTwoSensorsAreTwoMeasurements) {
  std::vector<SeveralSensors::Part> parts;
  parts.push_back({"a", sensor_of(kLaser)});
  parts.push_back({"b", sensor_of(kLaser)});
  const auto both = tracker(std::make_unique<SeveralSensors>(std::move(parts)));
  both->step(by_laser(0.0, 3.0, 4.0));
  Measurement again = by_laser(0.0, 3.0, 4.0);
  again.source = 1;
  EXPECT_EQ(both->step(again)[0].status, StepStatus::ok);
  EXPECT_EQ(both->step(again)[0].status, StepStatus::rejected);
  EXPECT_EQ(both->counts().repeated, 1);
}

TEST(SeveralSensors, MeasuredListsThemAll) {
  const Measured measured = SeveralSensors(laser_and_radar(false)).measured();
  EXPECT_EQ(describe(measured), "sensors (laser: east_m, north_m; radar: range_m, bearing_deg, range_rate_mps)");
  EXPECT_EQ(measured.components.size(), 5u);
  std::vector<SeveralSensors::Part> none = laser_and_radar(false);
  none[0].used = false;
  EXPECT_THROW(SeveralSensors{std::move(none)}, std::invalid_argument);
}

}  // namespace
}  // namespace truebearing::several_sensors_test
