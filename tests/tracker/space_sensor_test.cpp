// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tracker/space_sensor.hpp"

#include <gtest/gtest.h>

#include "tests/support/statistics.hpp"
#include "truebearing/core/constants.hpp"
#include "truebearing/core/covariance.hpp"
#include "truebearing/core/random.hpp"
#include "truebearing/filter/kalman.hpp"
#include "truebearing/motion/constant_velocity.hpp"
#include "truebearing/motion/turning_target.hpp"
#include "truebearing/motion/with_vertical.hpp"
#include "truebearing/tracker/filter_tracker_of.hpp"

namespace truebearing::space_sensor_test {
namespace {

using State = Eigen::Matrix<double, 6, 1>;

constexpr double kAlgebra = 1e-9;
const Eigen::Vector4d kSigma(10.0, 0.017, 0.05, 5.0);
const State kTruth{3000.0, -1000.0, 800.0, 60.0, 30.0, -5.0};

Measurement seen(const Eigen::Vector4d& noise, const std::optional<SensorState>& sensor = {}) {
  const SensorState at = sensor.value_or(SensorState{});
  const RangeBearingElevationRate<> model{{at.position_m.x(), at.position_m.y(), at.up_m},
                                          {at.velocity_mps.x(), at.velocity_mps.y(), at.climb_mps},
                                          kSigma};
  return {.time_s = 0.0, .z = BoundedVector(model.h(kTruth) + noise), .sigma = {}, .sensor = sensor};
}

// Without noise all of them see the truth where they should, from wherever they are.
TEST(SpaceSensor, SeesFromWhereItIs) {
  const SensorState moving{{500.0, 400.0}, {10.0, -20.0}, 90.0, 3.0};
  const SpaceSite<4> exact{Eigen::Vector4d::Constant(1e-9)};
  const ConvertedElevationRateSensor converted{exact, 0.6};
  for (const std::optional<SensorState>& sensor : {std::optional<SensorState>(), std::optional(moving)}) {
    const Measurement measurement = seen(Eigen::Vector4d::Zero(), sensor);
    const Prediction expected{kTruth, BoundedMatrix::Identity(6, 6)};
    EXPECT_LT((converted.fix(measurement).z - kTruth.head<3>()).norm(), 1e-6);
    const PositionAndRate<3> model = converted.model(measurement, expected);
    EXPECT_LT((converted.value(measurement) - model.h(kTruth)).norm(), 1e-6);
    const RangeBearingElevationRateSensor direct{exact, 0.6};
    EXPECT_LT((direct.value(measurement) - direct.model(measurement).h(kTruth)).norm(), kAlgebra);
  }
}

// A platform whose place is told in the plane only is as high as the site.
TEST(SpaceSensor, HeightThatIsNotToldIsThatOfTheSite) {
  SpaceSite<3> site{Eigen::Vector3d::Ones()};
  site.site_m = {1.0, 2.0, 300.0};
  Measurement measurement{.time_s = 0.0, .z = Eigen::Vector3d(5000.0, 0.1, 0.2), .sigma = {}, .sensor = {}};
  EXPECT_EQ(site.place(measurement), site.site_m);
  measurement.sensor = SensorState{{500.0, 400.0}, {10.0, -20.0}, kNaN};
  EXPECT_EQ(site.place(measurement), Eigen::Vector3d(500.0, 400.0, 300.0));
  EXPECT_EQ(site.velocity(measurement), Eigen::Vector3d(10.0, -20.0, 0.0));
  measurement.sensor->up_m = 0.0;
  EXPECT_EQ(site.place(measurement), Eigen::Vector3d(500.0, 400.0, 0.0));
}

TEST(SpaceSensor, TakesReportedDeviationsAndItsFactor) {
  RangeBearingElevationSensor sensor{{Eigen::Vector3d(10.0, 0.01, 0.02), 2.0}};
  Measurement measurement{.time_s = 0.0, .z = Eigen::Vector3d(5000.0, 0.1, 0.2), .sigma = {}, .sensor = {}};
  EXPECT_TRUE(sensor.model(measurement).sigma.isApprox(Eigen::Vector3d(20.0, 0.02, 0.04)));
  measurement.sigma = Eigen::Vector3d(1.0, 0.001, 0.003);
  EXPECT_TRUE(sensor.model(measurement).sigma.isApprox(Eigen::Vector3d(2.0, 0.002, 0.006)));
}

// What a chirp couples: with range and range rate correlated, the converted rate less its share of the range has an error
// of sqrt(1 - rho^2) sigma that does not go with the range's. Of 4000 draws the correlation is known to .016.
TEST(SpaceSensor, TakesTheRangesErrorOutOfTheRate) {
  constexpr double kRho = 0.8;
  constexpr int kDraws = 4000;
  const ConvertedElevationRateSensor sensor{{kSigma, 1.0}, kRho};
  RandomStream random({61, Role::evaluation, 0}, StreamId::test);
  std::vector<double> errors, products;
  for (int i = 0; i < kDraws; ++i) {
    const double a = random.normal(), b = random.normal();
    const Eigen::Vector4d noise(kSigma[0] * a, 0.0, 0.0, kSigma[3] * (kRho * a + std::sqrt(1.0 - kRho * kRho) * b));
    const Measurement measurement = seen(noise);
    const PositionAndRate<3> model = sensor.model(measurement, {kTruth, BoundedMatrix::Identity(6, 6)});
    const double error = (sensor.value(measurement) - model.h(kTruth))[3] / model.sigma_rate_mps;
    errors.push_back(error);
    products.push_back(error * a);
  }
  EXPECT_TRUE(testing::variance_fits(testing::moments(errors).variance, 1.0, kDraws));
  EXPECT_LT(std::abs(testing::moments(products).mean), 0.08);
}

// Two angles and a believed range: the start is along the sight, and as wide as is believed.
TEST(SpaceSensor, BeginsAlongTwoAngles) {
  const BearingElevationSensor sensor{{Eigen::Vector2d(0.01, 0.02), 1.0}};
  RangePrior prior;
  prior.range_m = 5000.0;
  prior.range_sigma_m = 1000.0;
  prior.velocity_sigma_mps = 50.0;
  const Measurement measurement{.time_s = 0.0, .z = Eigen::Vector2d(0.5, 0.3), .sigma = {}, .sensor = {}};
  const Sight sight = sensor.sight(measurement);
  const GaussianState plane = prior.state(sight.bearing_rad, sight.sigma_rad, sight.from, {});
  const std::optional<PriorStart> start = sensor.believe(plane, measurement);
  ASSERT_TRUE(start);
  const Eigen::Vector2d z = sensor.model(measurement).h(start->x);
  EXPECT_TRUE(z.isApprox(Eigen::Vector2d(0.5, 0.3), kAlgebra));
  EXPECT_TRUE(is_covariance(start->P));
  const Eigen::Matrix<double, 2, 6> H = sensor.model(measurement).H(start->x);
  const Eigen::Matrix2d S = H * start->P * H.transpose();
  EXPECT_NEAR(std::sqrt(S(0, 0)), 0.01, 3e-4);
  EXPECT_NEAR(std::sqrt(S(1, 1)), 0.02, 1e-3) << "the range that is not known does not make the elevation uncertain";
  EXPECT_EQ(start->P(5, 5), 2500.0);
}

// At the sensor itself the measurement leaves the track alone; and from there it goes on.
TEST(SpaceSensor, LosesTheDirectionAtRangeZero) {
  const PriorStart prior{BoundedVector::Zero(6), BoundedMatrix::Identity(6, 6)};
  using Motion = ConstantVelocity<3, ContinuousWhiteNoise>;
  FilterTrackerOf<KalmanFilter<6>, Motion, RangeBearingElevationRateSensor> tracker(
      space_space(), Motion{{0.1}}, RangeBearingElevationRateSensor{{kSigma, 1.0}, 0.5}, prior);
  const Measurement first = seen(Eigen::Vector4d::Zero());
  const auto records = tracker.step(first);
  ASSERT_EQ(records.size(), 1u);
  EXPECT_EQ(records[0].x, prior.x);
  EXPECT_TRUE(is_covariance(records[0].P));
}

// Tracks begin with one place or with two, also under a motion whose state is longer than the records'.
TEST(SpaceSensor, BeginsWithOnePlaceOrWithTwo) {
  using Turning = WithVertical<TurningTarget<ContinuousWhiteNoise>, ConstantVelocity<1, ContinuousWhiteNoise>>;
  const ConvertedElevationSensor sensor{{Eigen::Vector3d(1e-3, 1e-7, 1e-7)}};
  const Turning motion{{{1e-3}, 1e-4}, {{1e-3}}};
  for (const Start& start : {Start(OnePointStart{30.0, 0.1}), Start(TwoPointStart{0.1})}) {
    FilterTrackerOf<KalmanFilter<7>, Turning, ConvertedElevationSensor> tracker(space_space(), motion, sensor, start);
    std::span<const StepRecord> records;
    for (int k = 0; k < 3; ++k) {
      State x = kTruth;
      x.head<3>() += k * kTruth.tail<3>();
      const RangeBearingElevation<> model{Eigen::Vector3d::Zero(), Eigen::Vector3d::Ones()};
      records = tracker.step({.time_s = double(k), .z = model.h(x), .sigma = {}, .sensor = {}});
      EXPECT_EQ(records.size(), k == 0 && std::holds_alternative<TwoPointStart>(start) ? 0u : 1u);
    }
    ASSERT_EQ(records.size(), 1u);
    EXPECT_EQ(records[0].status, StepStatus::ok);
    ASSERT_EQ(records[0].x.size(), 6);
    EXPECT_LT((records[0].x.head<3>() - (kTruth.head<3>() + 2.0 * kTruth.tail<3>())).norm(), 0.1);
    EXPECT_LT((records[0].x.tail<3>() - kTruth.tail<3>()).norm(), 0.5);
    EXPECT_TRUE(is_covariance(records[0].P));
  }
}

// Aircraft climb more slowly than they fly.
TEST(SpaceSensor, ItsStartMayKnowMoreOfTheClimb) {
  const PositionFix fix{Eigen::Vector3d(1.0, 2.0, 3.0), 4.0 * Eigen::Matrix3d::Identity()};
  const PriorStart start = one_point_state(fix, {.velocity_sigma_mps = 100.0, .climb_sigma_mps = 5.0});
  EXPECT_EQ(start.P.diagonal(), (BoundedVector{{4.0, 4.0, 4.0, 1e4, 1e4, 25.0}}));
  EXPECT_EQ(one_point_state(fix, {.velocity_sigma_mps = 100.0}).P(5, 5), 1e4);
}

}  // namespace
}  // namespace truebearing::space_sensor_test
