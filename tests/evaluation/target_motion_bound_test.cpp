// SPDX-License-Identifier: Apache-2.0
#include "truebearing/evaluation/target_motion_bound.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "tests/support/error_message.hpp"
#include "truebearing/core/angle.hpp"
#include "truebearing/evaluation/time_steps.hpp"
#include "truebearing/measurement/range_bearing_rate.hpp"
#include "truebearing/simulation/bearings_only_scenario.hpp"

namespace truebearing::target_motion_bound_test {
namespace {

using testing::error_message;
using ::testing::HasSubstr;

Recording simulated(const std::string& scenario) {
  return load_scenario(std::string(TRUEBEARING_SOURCE_DIR) + "/data/scenarios/" + scenario)->simulate({});
}

TargetMotionVariance at(const TargetMotionBound& bound, const Recording& recording, double time_s) {
  return bound.variances(recording, steps_at(recording, {time_s})).front();
}

// problems/bearings-only.md, prototype figures. The prototype took no bearing at the very end of a turn, which falls on
// a sample in the first scenario alone.
TEST(TargetMotionBound, IsThatOfThePublishedGeometries) {
  const auto expect = [](const std::string& scenario, double time_s, double percent) {
    Recording recording = simulated(scenario);
    if (scenario == "cho_s1.toml") recording.measurements[65].z[0] = std::nan("");  // 260 s
    EXPECT_NEAR(std::sqrt(at({}, recording, time_s).range_percent2), percent, 0.015 * percent) << scenario << time_s;
  };
  expect("cho_s1.toml", 280.0, 39.7);
  expect("cho_s2.toml", 240.0, 118.0);
  expect("cho_s3.toml", 240.0, 62.0);
  expect("cho_s1.toml", 480.0, 22.3);
  expect("cho_s2.toml", 480.0, 34.0);
  expect("cho_s3.toml", 480.0, 10.8);
}

TEST(TargetMotionBound, CourseAndSpeedInTheFirstGeometry) {
  const Recording recording = simulated("cho_s1.toml");
  const double times_s[] = {480.0, 1000.0, 3600.0}, course_deg[] = {15.4, 0.73, 0.29}, speed[] = {0.63, 0.077, 0.030};
  for (std::size_t i = 0; i < 3; ++i) {
    const TargetMotionVariance variance = at({}, recording, times_s[i]);
    EXPECT_NEAR(std::sqrt(variance.course_deg2), course_deg[i], 0.02 * course_deg[i]);
    EXPECT_NEAR(std::sqrt(variance.speed_m2ps2), speed[i], 0.03 * speed[i]);
    EXPECT_NEAR(variance.velocity_m2ps2,
                variance.speed_m2ps2 + 25.0 * variance.course_deg2 * radians(1.0) * radians(1.0), 1e-9);
  }
}

// Arulampalam et al. 2004: km at k = 20, 25 and 32, k = 0 at the guess and own ship's turns at k = 13 to 16. Theirs is
// an expectation over targets with process noise, this one is along a straight course.
TEST(TargetMotionBound, WithItsPriorIsThePublishedPosteriorBound) {
  TargetMotionBound bound;
  bound.q_m2ps3 = 9e-6;
  bound.prior = RangePrior{};
  bound.prior->range_sigma_m = 2000.0;
  bound.prior->course = RangePrior::Course{2.056, 1.028, kPi, kPi / std::sqrt(12.0)};
  BearingsOnlyParameters parameters;
  parameters.period_s = 60.0;
  parameters.duration_s = 1920.0;
  parameters.own_ship.speed_mps = 2.57;
  parameters.own_ship.course_deg = 140.0;
  for (int k = 13; k <= 16; ++k) {
    VesselParameters::Turn turn;
    turn.time_s = 60.0 * k;
    turn.angle_deg = -30.0;
    turn.rate_degps = 1e6;
    parameters.own_ship.turns.push_back(turn);
  }
  parameters.range_m = 4992.9;
  parameters.bearing_deg = 80.198;
  parameters.target.speed_mps = 2.056;
  parameters.target.course_deg = -140.0;
  parameters.sensor.sigma_rad = radians(1.5);
  const Recording recording = BearingsOnlyScenario(parameters).simulate({});
  const double published_km[] = {0.128, 0.054, 0.088}, k[] = {20.0, 25.0, 32.0};
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(1e-3 * std::sqrt(at(bound, recording, 60.0 * k[i]).position_m2), published_km[i],
                0.03 * published_km[i]);
}

TEST(TargetMotionBound, BeforeOwnShipTurnsThereIsNoneWithoutAPrior) {
  const Recording recording = simulated("cho_s1.toml");
  TargetMotionBound bound;
  EXPECT_TRUE(std::isnan(at(bound, recording, 200.0).range_percent2));
  EXPECT_TRUE(std::isnan(at(bound, recording, 0.0).range_percent2));
  bound.prior =
      RangePrior{.range_m = 1.0, .range_sigma_m = 3000.0, .between = {}, .velocity_sigma_mps = 4.0, .course = {}};
  EXPECT_NEAR(std::sqrt(at(bound, recording, 0.0).range_percent2), 50.0, 1e-6) << "3 km of the true 6 km";
  const double before = at(bound, recording, 200.0).range_percent2;
  EXPECT_GT(before, 0.0);
  EXPECT_LT(at(bound, recording, 280.0).range_percent2, at(TargetMotionBound{}, recording, 280.0).range_percent2);
}

TEST(TargetMotionBound, MissingBearingsAddNothingAndOthersCountByTheirSigma) {
  Recording recording = simulated("cho_s3.toml");
  const double whole = at({}, recording, 1000.0).position_m2;
  for (std::size_t k = 0; k < recording.measurements.size(); k += 2) recording.measurements[k].z[0] = std::nan("");
  EXPECT_NEAR(at({}, recording, 1000.0).position_m2 / whole, 2.0, 0.1);

  recording = simulated("cho_s3.toml");
  for (Measurement& measurement : recording.measurements) measurement.sigma *= 3.0;
  EXPECT_NEAR(at({}, recording, 1000.0).position_m2 / whole, 9.0, 1e-6);
  for (Measurement& measurement : recording.measurements) measurement.sigma.resize(0);
  TargetMotionBound bound;
  EXPECT_THAT(error_message([&] { at(bound, recording, 1000.0); }), HasSubstr("bearing_sigma_deg"));
  bound.bearing_sigma_rad = radians(1.0);
  EXPECT_NEAR(at(bound, recording, 1000.0).position_m2 / whole, 1.0, 1e-9);
}

TEST(TargetMotionBound, StateAtATimeIsThatOfTheStep) {
  const Recording recording = simulated("cho_s1.toml");
  EXPECT_EQ(at({}, recording, 1001.0).position_m2, at({}, recording, 1000.0).position_m2);
  EXPECT_NE(at({}, recording, 1004.0).position_m2, at({}, recording, 1000.0).position_m2);
}

TEST(TargetMotionBound, WhatItDoesNotHoldForIsRefused) {
  Recording recording = simulated("cho_s1.toml");
  const TargetMotionBound bound;
  recording.measured = {"east_m", "north_m"};
  EXPECT_THAT(error_message([&] { at(bound, recording, 1000.0); }), HasSubstr("east_m, north_m"));
  recording = simulated("cho_s1.toml");
  recording.measurements[3].sensor.reset();
  EXPECT_THAT(error_message([&] { at(bound, recording, 1000.0); }), HasSubstr("own ship"));
  recording = simulated("passive_sonar_b.toml");
  recording.truth_space = &plane_space();
  EXPECT_THAT(error_message([&] { at(bound, recording, 1000.0); }), HasSubstr("frequencies = false"));
  recording = simulated("passive_sonar_b.toml");
  for (Measurement& measurement : recording.measurements) measurement.sigma.resize(0);
  TargetMotionBound known;
  known.bearing_sigma_rad = radians(1.0);
  EXPECT_THAT(error_message([&] { at(known, recording, 1000.0); }), HasSubstr("frequency_sigma_hz"));
  known.frequency_sigma_hz = 0.02;
  EXPECT_NEAR(at(known, recording, 1050.0).position_m2,
              at(bound, simulated("passive_sonar_b.toml"), 1050.0).position_m2, 1e-6);
}

TEST(TargetMotionBound, OfATargetThatTurnsEndsThere) {
  Recording recording = simulated("cho_s1.toml");
  const double before = at({}, recording, 900.0).position_m2;
  for (std::size_t k = 250; k < recording.truth[0].x.size(); ++k) recording.truth[0].x[k][2] += 0.5;  // from 1000 s
  EXPECT_EQ(at({}, recording, 900.0).position_m2, before);
  EXPECT_GT(at({}, recording, 996.0).position_m2, 0.0);
  EXPECT_TRUE(std::isnan(at({}, recording, 1000.0).position_m2));
  EXPECT_TRUE(std::isnan(at({}, recording, 3000.0).position_m2));
  TargetMotionBound with_noise;
  with_noise.q_m2ps3 = 1e-3;
  EXPECT_GT(at(with_noise, recording, 1000.0).position_m2, 0.0);

  recording = simulated("cho_s1.toml");
  recording.truth[0].x[100].setConstant(std::nan(""));  // what is not known is no turn
  EXPECT_GT(at({}, recording, 1000.0).position_m2, 0.0);
}

// problems/passive-sonar.md, prototype figures at 1050 s.
TEST(TargetMotionBound, OfPassiveSonarIsThatOfThePublishedCase) {
  const Recording recording = simulated("passive_sonar_a.toml");
  const TargetMotionVariance both = at({}, recording, 1050.0);
  EXPECT_NEAR(std::sqrt(both.position_m2), 155.27, 0.05);
  EXPECT_NEAR(std::sqrt(both.velocity_m2ps2), 0.1506, 1e-4);
  EXPECT_NEAR(std::sqrt(both.frequency_hz2), 0.00722, 1e-5);
  TargetMotionBound bearings;
  bearings.frequencies = false;
  const TargetMotionVariance alone = at(bearings, recording, 1050.0);
  EXPECT_NEAR(std::sqrt(alone.position_m2), 530.8, 0.2);
  EXPECT_NEAR(std::sqrt(alone.velocity_m2ps2), 0.4130, 2e-4);
  EXPECT_TRUE(std::isnan(alone.frequency_hz2));
  EXPECT_GT(at({}, recording, 1498.0).position_m2, 0.0);
  EXPECT_TRUE(std::isnan(at({}, recording, 1505.0).position_m2)) << "the target turns at 1500 s";
}

// The whole information about [x0, levels], from derivatives by differences, inverted at once. Returned as the
// covariance of [x at `at_s`, levels].
Eigen::MatrixXd covariance_by_hand(const Recording& recording, double at_s, const std::vector<double>& levels_hz) {
  const auto n = static_cast<Eigen::Index>(4 + levels_hz.size());
  Eigen::VectorXd truth(n), step = Eigen::VectorXd::Constant(n, 1e-3);
  truth.head<4>() = recording.truth[0].x[0].head<4>();
  for (Eigen::Index i = 4; i < n; ++i) truth[i] = levels_hz[static_cast<std::size_t>(i - 4)];
  step.head<2>().setConstant(1.0);
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(n, n);
  for (std::size_t k = 0; k < recording.measurements.size() && recording.measurements[k].time_s <= at_s; ++k) {
    const Measurement& m = recording.measurements[k];
    Eigen::Index level = 4;
    while (truth[level] != recording.truth[0].x[k][4]) ++level;
    const auto h = [&](const Eigen::VectorXd& x) {
      const Eigen::Vector2d offset = x.head<2>() + m.time_s * x.segment<2>(2) - m.sensor->position_m;
      const Eigen::Vector2d v = x.segment<2>(2) - m.sensor->velocity_mps;
      return Eigen::Vector2d(std::atan2(offset.x(), offset.y()),
                             x[level] * (1.0 - v.dot(offset.normalized()) / 1500.0));
    };
    for (Eigen::Index row = 0; row < 2; ++row) {
      if (std::isnan(m.z[row])) continue;
      Eigen::VectorXd g(n);
      for (Eigen::Index i = 0; i < n; ++i) {
        const Eigen::VectorXd d = step[i] * Eigen::VectorXd::Unit(n, i);
        g[i] = (h(truth + d)[row] - h(truth - d)[row]) / (2.0 * step[i]) / m.sigma[row];
      }
      J += g * g.transpose();
    }
  }
  Eigen::MatrixXd F = Eigen::MatrixXd::Identity(n, n);
  F.block<2, 2>(0, 2) = at_s * Eigen::Matrix2d::Identity();
  const Eigen::VectorXd scale = J.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * J * scale.asDiagonal();
  const Eigen::MatrixXd P = scale.asDiagonal() * Eigen::MatrixXd(scaled.inverse()) * scale.asDiagonal();
  return F * P * F.transpose();
}

TEST(TargetMotionBound, HasOneUnknownForEachFrequencyOfTheSource) {
  Recording recording = simulated("passive_sonar_b.toml");
  // Now and then a bearing or a frequency comes alone; the first frequency of the jump does not come at all.
  for (std::size_t k = 0; k < recording.measurements.size(); ++k) {
    Measurement& m = recording.measurements[k];
    if (k % 5 == 2) m.z[0] = std::nan("");
    if (k % 7 == 3 || (m.time_s >= 600.0 && m.time_s < 610.0)) m.z[1] = std::nan("");
  }
  for (const double at_s : {700.0, 1050.0}) {
    const Eigen::MatrixXd P = covariance_by_hand(recording, at_s, {100.0, 130.0});
    const TargetMotionVariance bound = at({}, recording, at_s);
    EXPECT_NEAR(bound.position_m2 / P.topLeftCorner(2, 2).trace(), 1.0, 1e-4) << at_s;
    EXPECT_NEAR(bound.velocity_m2ps2 / P.block(2, 2, 2, 2).trace(), 1.0, 1e-4) << at_s;
    EXPECT_NEAR(bound.frequency_hz2 / (at_s == 700.0 ? P(5, 5) : P(4, 4)), 1.0, 1e-4) << "of the frequency then";
  }
  const TargetMotionVariance unheard = at({}, recording, 602.0);  // no word of the new frequency yet
  EXPECT_GT(unheard.position_m2, 0.0);
  EXPECT_TRUE(std::isnan(unheard.frequency_hz2));
}

TEST(TargetMotionBound, AFrequencyOfItsOwnForEverySegmentWouldTellLess) {
  Recording back = simulated("passive_sonar_b.toml"), other = back;
  for (std::size_t k = 0; k < other.measurements.size(); ++k)
    if (other.measurements[k].time_s >= 800.0) other.truth[0].x[k][4] = 100.001;
  EXPECT_NEAR(std::sqrt(at({}, back, 1050.0).position_m2), 161.46, 0.05) << "it comes back to what it was";
  EXPECT_NEAR(std::sqrt(at({}, other, 1050.0).position_m2), 270.1, 0.1);
}

TEST(TargetMotionBound, WithAPriorFrequenciesAddToIt) {
  const Recording recording = simulated("passive_sonar_a.toml");
  TargetMotionBound both;
  both.prior =
      RangePrior{.range_m = 1.0, .range_sigma_m = 3000.0, .between = {}, .velocity_sigma_mps = 3.0, .course = {}};
  TargetMotionBound bearings = both;
  bearings.frequencies = false;
  EXPECT_NEAR(at(both, recording, 0.0).position_m2, at(bearings, recording, 0.0).position_m2, 1e-3)
      << "not of the position";
  EXPECT_LT(at(both, recording, 1050.0).position_m2, 0.2 * at(bearings, recording, 1050.0).position_m2);
  EXPECT_LT(at(both, recording, 1050.0).position_m2, at({}, recording, 1050.0).position_m2);
}

// Of a radar: the inverse of the information about the last state that all measurements of a straight course have, summed
// up without a recursion.
TEST(TargetMotionBound, OfARadarIsTheInformationOfAllMeasurements) {
  Recording recording;
  recording.measured = RangeBearingRate<>::measured().components;
  recording.truth_space = &plane_space();
  recording.truth.resize(1);
  const Eigen::Vector4d last(9000.0, 12000.0, -150.0, 100.0);
  constexpr int kSteps = 30;
  const RangeBearingRate<> radar{{0.0, 0.0}, {0.0, 0.0}, 50.0, 0.005, 1.0, 0.6};
  Eigen::Matrix4d with = Eigen::Matrix4d::Zero(), without = with;
  for (int k = 1; k <= kSteps; ++k) {
    Eigen::Matrix4d back = Eigen::Matrix4d::Identity();
    back(0, 2) = back(1, 3) = k - kSteps;
    const Eigen::Vector4d x = back * last;
    recording.measurements.push_back({.time_s = double(k), .z = radar.h(x), .sigma = {}, .sensor = {}});
    recording.truth[0].x.emplace_back(x);
    const Eigen::Matrix<double, 3, 4> G = radar.H(x) * back;
    const Eigen::Matrix3d R = radar.R();
    with += G.transpose() * R.inverse() * G;
    without += G.topRows<2>().transpose() * R.topLeftCorner<2, 2>().inverse() * G.topRows<2>();
  }
  TargetMotionBound bound;
  EXPECT_THAT(error_message([&] { at(bound, recording, 30.0); }), HasSubstr("range_sigma_m"));
  bound.range_sigma_m = 50.0;
  bound.bearing_sigma_rad = 0.005;
  bound.range_rate_sigma_mps = 1.0;
  bound.range_rate_correlation = 0.6;
  const auto expect = [&](const Eigen::Matrix4d& J) {
    const TargetMotionVariance variance = at(bound, recording, 30.0);
    const Eigen::Matrix4d P = J.inverse();
    EXPECT_NEAR(variance.position_m2, (P.topLeftCorner<2, 2>().trace()), 1e-6 * variance.position_m2);
    EXPECT_NEAR(variance.velocity_m2ps2, (P.bottomRightCorner<2, 2>().trace()), 1e-6 * variance.velocity_m2ps2);
    return variance.velocity_m2ps2;
  };
  const double told = expect(with);
  bound.range_rates = false;
  EXPECT_GT(expect(without), 1.2 * told) << "what the range rate tells";
  recording.measured.pop_back();
  for (Measurement& measurement : recording.measurements) measurement.z.conservativeResize(2);
  expect(without);
  bound.prior.emplace();
  EXPECT_THAT(error_message([&] { at(bound, recording, 30.0); }), HasSubstr("prior"));
}

}  // namespace
}  // namespace truebearing::target_motion_bound_test
