// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tracker/range_rate_sensor.hpp"

#include <gtest/gtest.h>

#include "tests/support/statistics.hpp"
#include "truebearing/core/random.hpp"
#include "truebearing/filter/kalman.hpp"
#include "truebearing/tracker/polar_sensor.hpp"

namespace truebearing::range_rate_sensor_test {
namespace {

const Eigen::Vector4d kExpected(3000.0, 4000.0, 20.0, -30.0);
const Eigen::Matrix4d kP = Eigen::Vector4d(1e4, 4e4, 400.0, 900.0).asDiagonal();

Measurement seen(const Eigen::Vector3d& z, const std::optional<SensorState>& sensor = {}) {
  return {.time_s = 0.0, .z = z, .sigma = {}, .sensor = sensor};
}

Measurement seen_at_rest() {
  return seen({5000.0, 0.6, 0.0});
}

RangeBearingRateSensor polar(double correlation) {
  return {{50.0, 0.02, 1.0}, 1.0, {100.0, -50.0}, correlation};
}

// Position first, then the range rate linearised about what came of it, each by a filter's own update: the sensor's one
// update with both is the same.
TEST(ConvertedRate, IsTheTwoUpdatesOneAfterTheOther) {
  for (const double rho : {0.0, 0.8}) {
    const ConvertedRateSensor sensor{polar(rho)};
    const Measurement measurement = seen({5100.0, 0.66, -11.0});
    const Prediction expected{kExpected, kP};
    KalmanFilter<4> one_after_the_other(kExpected, kP), together(kExpected, kP);

    const PositionAndRate<2> model = sensor.model(measurement, expected);
    const Eigen::Vector3d z = sensor.value(measurement);
    ASSERT_EQ(together.update(model, z).status, StepStatus::ok);

    ASSERT_EQ(one_after_the_other.update(CartesianPosition<2>{model.R_m2}, z.head<2>()).status, StepStatus::ok);
    const RangeBearingRate<> radar = sensor.polar.model(measurement);
    const double c = rho * radar.sigma_rate_mps / radar.sigma_range_m;
    const Eigen::Vector4d between = one_after_the_other.x();
    const Eigen::Vector3d h = radar.h(between);
    const Eigen::Matrix<double, 3, 4> H = radar.H(between);
    const Eigen::RowVector4d row = H.row(2) - c * H.row(0);
    const double variance = radar.sigma_rate_mps * radar.sigma_rate_mps * (1.0 - rho * rho);
    const double S = row * one_after_the_other.P() * row.transpose() + variance;
    const Eigen::Vector4d K = one_after_the_other.P() * row.transpose() / S;
    const Eigen::Vector4d x = between + K * ((measurement.z[2] - c * measurement.z[0]) - (h[2] - c * h[0]));
    const Eigen::Matrix4d P = one_after_the_other.P() - K * S * K.transpose();
    EXPECT_LT((together.x() - x).norm(), 1e-9 * x.norm()) << rho;
    EXPECT_LT((together.P() - P).norm(), 1e-9 * P.norm()) << rho;
    EXPECT_GT((x - between).tail<2>().norm(), 0.5) << "the range rate says something";
  }
}

// Against draws of what is left of a range rate without its first order: four standard errors of mean and variance.
TEST(RangeRateCurvature, IsWhatTheSecondOrderMakesOfAnUncertainState) {
  const RangeBearingRate<> seen = polar(0.0).model(seen_at_rest());
  Eigen::Matrix4d P = Eigen::Vector4d(1e4, 4e4, 9e4, 16e4).asDiagonal();
  P(0, 2) = P(2, 0) = 2e4;
  P(1, 3) = P(3, 1) = -5e4;
  const RangeRateCurvature found = range_rate_curvature(seen, kExpected, P);
  const Eigen::Matrix4d root = P.llt().matrixL();
  RandomStream random({5, Role::evaluation, 0}, StreamId::test);
  constexpr int kDraws = 200000;
  double sum = 0.0, squares = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const Eigen::Vector4d u(random.normal(), random.normal(), random.normal(), random.normal());
    const Eigen::Vector4d d = root * u;
    // Of d and -d together odd orders go out.
    const double rest = 0.5 * (seen.h(kExpected + d)[2] + seen.h(kExpected - d)[2]) - seen.h(kExpected)[2];
    sum += rest;
    squares += rest * rest;
  }
  const double mean = sum / kDraws, variance = squares / kDraws - mean * mean;
  EXPECT_NEAR(found.mean_mps, mean, 4.0 * std::sqrt(variance / kDraws) + 0.01 * std::abs(mean));
  EXPECT_NEAR(found.variance_m2ps2, variance, 0.06 * variance) << "what is left is of the fourth order";
  EXPECT_GT(found.variance_m2ps2, 50.0);
  EXPECT_EQ(range_rate_curvature(seen, Eigen::Vector4d(100.0, -50.0, 3.0, 4.0), P).variance_m2ps2, 0.0);
}

// Each has the second order of what it linearises about, and its own errors beside it.
TEST(RangeRateCurvature, IsTakenByBothFormsOfTheSensor) {
  const Prediction expected{kExpected, Eigen::Vector4d(1e4, 4e4, 9e4, 16e4).asDiagonal()};
  const Measurement measurement = seen({5100.0, 0.66, -11.0});
  const RangeBearingRateSensor radar = polar(0.5);
  const RangeBearingRate<> plain = radar.model(measurement);
  const RangeRateCurvature curvature = range_rate_curvature(plain, kExpected, expected.P);
  const SecondOrderRateSensor::Model model = SecondOrderRateSensor{radar}.model(measurement, expected);
  EXPECT_NEAR(model.h(kExpected)[2] - plain.h(kExpected)[2], curvature.mean_mps, 1e-9);
  EXPECT_NEAR(model.R()(2, 2) - plain.R()(2, 2), curvature.variance_m2ps2, 1e-9 * curvature.variance_m2ps2);
  EXPECT_NEAR(model.R()(0, 2), plain.R()(0, 2), 1e-9) << "the second order has nothing in common with the range";
  const PositionAndRate<2> first = ConvertedRateSensor{radar}.model(measurement, expected);
  const PositionAndRate<2> second = ConvertedRateSensor{radar, true}.model(measurement, expected);
  EXPECT_EQ(first.row, second.row);
  EXPECT_GT(second.sigma_rate_mps, first.sigma_rate_mps);
  EXPECT_LT(second.sigma_rate_mps, std::sqrt(model.R()(2, 2))) << "the position is known better by then";
}

TEST(ConvertedRate, WithoutNoiseIsTheTruth) {
  const SensorState moving{{500.0, 400.0}, {10.0, -20.0}};
  for (const std::optional<SensorState>& sensor : {std::optional<SensorState>(), std::optional(moving)}) {
    RangeBearingRateSensor exact = polar(0.7);
    exact.sigma_factor = 1e-8;
    const ConvertedRateSensor converted{exact};
    const Measurement measurement = seen(exact.model(seen({0.0, 0.0, 0.0}, sensor)).h(kExpected), sensor);
    const PositionAndRate<2> model = converted.model(measurement, {kExpected, kP});
    EXPECT_LT((converted.value(measurement) - model.h(kExpected)).norm(), 1e-6);
    const PartialRangeRateSensor<RangeAndRate> part{{1.0, 1.0}, 1.0, exact.site_m, 0.5};
    const Measurement of_part{
        .time_s = 0.0, .z = Eigen::Vector2d(measurement.z[0], measurement.z[2]), .sigma = {}, .sensor = sensor};
    EXPECT_LT((part.value(of_part) - part.model(of_part).h(kExpected)).norm(), 1e-9);
    EXPECT_EQ(part.model(of_part).R()(0, 1), 0.5);
  }
}

TEST(ConvertedRate, StaysAtTheSite) {
  const ConvertedRateSensor sensor{polar(0.5)};
  const Prediction expected{Eigen::Vector4d(100.0, -50.0, 1.0, 2.0), BoundedMatrix::Identity(4, 4)};
  const PositionAndRate<2> model = sensor.model(seen({0.0, 0.3, 1.0}), expected);
  EXPECT_TRUE(model.row.allFinite());
  EXPECT_TRUE(std::isfinite(model.offset_mps));
}

// Sensors of a place take it from a Doppler radar and leave the range rate alone.
TEST(PolarSensor, LeavesARangeRateAlone) {
  const PolarSensor place{{50.0, 0.02}};
  Measurement with = seen({5000.0, 0.6, 7.0});
  const Measurement without{.time_s = 0.0, .z = Eigen::Vector2d(5000.0, 0.6), .sigma = {}, .sensor = {}};
  EXPECT_TRUE(place.has_value(with));
  EXPECT_EQ(place.value(with), place.value(without));
  EXPECT_EQ(place.fix(with).z, place.fix(without).z);
  with.z[2] = std::nan("");
  EXPECT_TRUE(place.has_value(with)) << "nor does it matter whether there is one";
  with.z[1] = std::nan("");
  EXPECT_FALSE(place.has_value(with));
  const Measured given = RangeBearingRate<>::measured();
  EXPECT_FALSE(mismatch(place.measured(), given, "the scenario"));
  EXPECT_TRUE(mismatch(given, place.measured(), "the scenario")) << "but not the other way round";
}

}  // namespace
}  // namespace truebearing::range_rate_sensor_test
