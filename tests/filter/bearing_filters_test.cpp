// SPDX-License-Identifier: Apache-2.0
// What every filter of bearings promises, on runs of one family: extended, unscented, modified-gain and log-polar.
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "tests/support/bearings.hpp"
#include "truebearing/core/constants.hpp"
#include "truebearing/core/covariance.hpp"
#include "truebearing/filter/kalman.hpp"
#include "truebearing/filter/log_polar.hpp"
#include "truebearing/filter/modified_gain.hpp"
#include "truebearing/filter/unscented.hpp"
#include "truebearing/motion/constant_velocity.hpp"
#include "truebearing/tma/range_prior.hpp"

namespace truebearing::bearing_filters_test {
namespace {

constexpr double kManySteps = 1e-7;

using Motion = ConstantVelocity<2, ContinuousWhiteNoise>;
using Vector1 = Eigen::Matrix<double, 1, 1>;
const Motion kMotion{{1e-5}};

Bearing<> seen(const Measurement& measurement) {
  return {measurement.sensor->position_m, measurement.sensor->velocity_mps, measurement.sigma[0]};
}

GaussianState prior_of(const Measurement& first) {
  RangePrior prior;
  prior.velocity_sigma_mps = 4.0;
  return prior.state(first.z[0], first.sigma[0], *first.sensor, first.guess);
}

template <typename Filter>
Filter started(const Measurement& first) {
  const GaussianState start = prior_of(first);
  return Filter(start.x, start.P);
}

template <typename Filter>
class BearingFilter : public ::testing::Test {};
using Filters = ::testing::Types<KalmanFilter<4>, UnscentedKalmanFilter<4>, ModifiedGainFilter<4>, LogPolarFilter<>>;
TYPED_TEST_SUITE(BearingFilter, Filters);

TYPED_TEST(BearingFilter, CovarianceIsSymmetricAndPositiveAtEveryStep) {
  for (std::uint64_t run = 0; run < 40; ++run) {
    const Recording recording = testing::bearings_run(run);
    TypeParam filter = started<TypeParam>(recording.measurements[0]);
    for (std::size_t k = 1; k < recording.measurements.size(); ++k) {
      const Measurement& measurement = recording.measurements[k];
      ASSERT_EQ(filter.predict(kMotion, 8.0), StepStatus::ok);
      ASSERT_TRUE(is_covariance(filter.P()));
      ASSERT_EQ(filter.update(seen(measurement), measurement.z).status, StepStatus::ok) << run << " " << k;
      ASSERT_TRUE(is_covariance(filter.P())) << run << " " << k << "\n" << filter.P();
      ASSERT_EQ(filter.P(), filter.P().transpose().eval());
    }
  }
}

TYPED_TEST(BearingFilter, TurnsAndMovesWithThePicture) {
  const Eigen::Rotation2D<double> turn(-2.0);  // clockwise is negative there
  const Eigen::Vector2d shift(3e4, -5e4);
  Eigen::Matrix4d R = Eigen::Matrix4d::Zero();
  R.topLeftCorner<2, 2>() = R.bottomRightCorner<2, 2>() = turn.toRotationMatrix();
  const Recording recording = testing::bearings_run(3);
  const auto moved = [&](Measurement measurement) {
    measurement.z[0] += 2.0;
    measurement.sensor->position_m = (turn * measurement.sensor->position_m + shift).eval();
    measurement.sensor->velocity_mps = (turn * measurement.sensor->velocity_mps).eval();
    return measurement;
  };
  TypeParam filter = started<TypeParam>(recording.measurements[0]);
  TypeParam other = started<TypeParam>(moved(recording.measurements[0]));
  for (std::size_t k = 1; k < recording.measurements.size(); ++k) {
    const Measurement &a = recording.measurements[k], b = moved(a);
    filter.predict(kMotion, 8.0);
    other.predict(kMotion, 8.0);
    ASSERT_EQ(filter.update(seen(a), a.z).status, StepStatus::ok);
    ASSERT_EQ(other.update(seen(b), b.z).status, StepStatus::ok);
  }
  // The points of an unscented filter are another set in the turned picture: only nearly the same.
  const double tolerance = std::is_same_v<TypeParam, UnscentedKalmanFilter<4>> ? 0.1 : kManySteps;
  Eigen::Vector4d expected = R * filter.x();
  expected.head<2>() += shift;
  EXPECT_LT((other.x() - expected).norm(), tolerance * std::sqrt(filter.P().trace()));
  EXPECT_LT((other.P() - R * filter.P() * R.transpose()).norm(), 10.0 * tolerance * filter.P().norm());
}

TYPED_TEST(BearingFilter, WholeTurnsOfABearingChangeNothing) {
  const Recording recording = testing::bearings_run(4);
  TypeParam filter = started<TypeParam>(recording.measurements[0]), turned = filter;
  for (std::size_t k = 1; k < recording.measurements.size(); ++k) {
    const Measurement& measurement = recording.measurements[k];
    filter.predict(kMotion, 8.0);
    turned.predict(kMotion, 8.0);
    const double turns = static_cast<double>(k % 5) - 2.0;
    filter.update(seen(measurement), measurement.z);
    turned.update(seen(measurement), Vector1(measurement.z[0] + 2.0 * kPi * turns));
  }
  EXPECT_LT((filter.x() - turned.x()).norm(), kManySteps * filter.x().norm());
  EXPECT_LT((filter.P() - turned.P()).norm(), kManySteps * filter.P().norm());
}

TYPED_TEST(BearingFilter, WorthlessBearingChangesNothing) {
  TypeParam filter = started<TypeParam>(testing::bearings_run(5).measurements[0]);
  const Eigen::Vector4d x = filter.x();
  const Eigen::Matrix4d P = filter.P();
  ASSERT_EQ(filter.update(Bearing<>{{100.0, 50.0}, {3.0, 1.0}, 1e90}, Vector1(1.0)).status, StepStatus::ok);
  EXPECT_LT((filter.x() - x).norm(), 1e-9 * x.norm());
  EXPECT_LT((filter.P() - P).norm(), 1e-9 * P.norm());
}

TYPED_TEST(BearingFilter, FailedStepLeavesTheStateAlone) {
  TypeParam filter = started<TypeParam>(testing::bearings_run(6).measurements[0]);
  const Eigen::Vector4d x = filter.x();
  const Eigen::Matrix4d P = filter.P();
  const Bearing<> good{{0.0, 0.0}, {5.0, 0.0}, 0.02};
  Bearing<> unsure = good, nowhere = good;
  unsure.sigma_rad = kNaN;
  nowhere.site_m.x() = kNaN;
  EXPECT_EQ(filter.update(good, Vector1(kNaN)).status, StepStatus::failed);
  EXPECT_EQ(filter.update(unsure, Vector1(1.0)).status, StepStatus::failed);
  EXPECT_EQ(filter.update(nowhere, Vector1(1.0)).status, StepStatus::failed);
  EXPECT_EQ(filter.predict(kMotion, kNaN), StepStatus::failed);
  EXPECT_EQ(filter.x(), x);
  EXPECT_EQ(filter.P(), P);
  TypeParam nonsense(x, -P);
  EXPECT_EQ(nonsense.update(good, Vector1(1.0)).status, StepStatus::failed);
}

// g = H where the measurement is linear: the plain Kalman filter.
struct LinearBearing : Bearing<> {
  Vector h(const State& x) const { return Vector(0.3 * x(0) - 0.4 * x(1) + x(3)); }
  Jacobian H(const State&) const { return Jacobian(0.3, -0.4, 0.0, 1.0); }
  Jacobian modified_gain(const Vector&, const State& x) const { return H(x); }
  Vector residual(const Vector& z, const Vector& z_pred) const { return z - z_pred; }
};

TEST(ModifiedGainFilter, IsTheKalmanFilterWhereTheMeasurementIsLinear) {
  RandomStream random({41, Role::evaluation, 0}, StreamId::test);
  const Eigen::Vector4d x0(100.0, -50.0, 3.0, 4.0);
  const Eigen::Matrix4d P0 = Eigen::Vector4d(1e4, 2e4, 9.0, 16.0).asDiagonal();
  KalmanFilter<4> kalman(x0, P0);
  ModifiedGainFilter<4> modified(x0, P0);
  const LinearBearing model{{{0.0, 0.0}, {0.0, 0.0}, 5.0}};
  for (int k = 0; k < 50; ++k) {
    kalman.predict(kMotion, 2.0);
    modified.predict(kMotion, 2.0);
    const Vector1 z(50.0 * random.normal());
    const auto a = kalman.update(model, z);
    const auto b = modified.update(model, z);
    ASSERT_LT((a.K - b.K).norm(), 1e-12 * a.K.norm());
    ASSERT_NEAR(a.nis, b.nis, 1e-12 * (1.0 + a.nis));
    ASSERT_LT((kalman.x() - modified.x()).norm(), 1e-12 * kalman.x().norm());
    ASSERT_LT((kalman.P() - modified.P()).norm(), 1e-12 * kalman.P().norm());
  }
}

TEST(ModifiedGainFilter, TakesTheGainFromHAndTheCovarianceFromTheModifiedGain) {
  const Recording recording = testing::bearings_run(8);
  ModifiedGainFilter<4> filter = started<ModifiedGainFilter<4>>(recording.measurements[0]);
  for (std::size_t k = 1; k < 60; ++k) {
    filter.predict(kMotion, 8.0);
    const Measurement& measurement = recording.measurements[k];
    const Bearing<> model = seen(measurement);
    const Eigen::Vector4d x = filter.x();
    const Eigen::Matrix4d P = filter.P();
    const Eigen::RowVector4d H = model.H(x), g = model.modified_gain(measurement.z, x);
    const double S = H * P * H.transpose() + model.R()(0);
    const Eigen::Vector4d K = P * H.transpose() / S;
    const Eigen::Matrix4d A = Eigen::Matrix4d::Identity() - K * g;
    const Eigen::Matrix4d expected = A * P * A.transpose() + K * model.R()(0) * K.transpose();
    const auto update = filter.update(model, measurement.z);
    ASSERT_LT((update.K - K).norm(), 1e-9 * K.norm());
    ASSERT_LT((filter.x() - x - K * update.nu).norm(), 1e-9 * x.norm());
    ASSERT_LT((filter.P() - expected).norm(), 1e-9 * expected.norm());
  }
}

// The filter as its name says it: state and covariance carried in log-polar coordinates throughout.
struct PlainLogPolarFilter {
  Eigen::Vector4d y;
  Eigen::Matrix4d P;

  void step(const Measurement& last, const Measurement& now, double dt_s) {
    const SensorState &from = *last.sensor, &to = *now.sensor;
    const Eigen::Matrix4d F = kMotion.F(dt_s);
    const Eigen::Matrix4d J = from_log_polar_jacobian<double>(y);
    const Eigen::Vector4d x = F * from_log_polar<double>(y, from.position_m, from.velocity_mps);
    const Eigen::Matrix4d G = log_polar_jacobian<double>(x, to.position_m, to.velocity_mps);
    y = log_polar<double>(x, to.position_m, to.velocity_mps);
    const Eigen::Matrix4d transition = G * F * J;
    P = (transition * P * transition.transpose() + G * kMotion.Q(dt_s) * G.transpose()).eval();
    const Eigen::RowVector4d H(1.0, 0.0, 0.0, 0.0);
    const double R = now.sigma[0] * now.sigma[0], S = P(0, 0) + R;
    const Eigen::Vector4d K = P.col(0) / S;
    const Eigen::Matrix4d A = Eigen::Matrix4d::Identity() - K * H;
    y += K * wrap_pi(now.z[0] - y(0));
    P = (A * P * A.transpose() + K * R * K.transpose()).eval();
  }
};

TEST(LogPolarFilter, IsTheExtendedFilterInLogPolarCoordinates) {
  for (std::uint64_t run = 0; run < 20; ++run) {
    const Recording recording = testing::bearings_run(run);
    const Measurement& first = recording.measurements[0];
    const GaussianState start = prior_of(first);
    LogPolarFilter<> filter(start.x, start.P);
    const Eigen::Matrix4d G = log_polar_jacobian<double>(start.x, first.sensor->position_m, first.sensor->velocity_mps);
    PlainLogPolarFilter plain{log_polar<double>(start.x, first.sensor->position_m, first.sensor->velocity_mps),
                              G * start.P * G.transpose()};
    for (std::size_t k = 1; k < recording.measurements.size(); ++k) {
      const Measurement& now = recording.measurements[k];
      filter.predict(kMotion, 8.0);
      filter.update(seen(now), now.z);
      plain.step(recording.measurements[k - 1], now, 8.0);
      const Eigen::Vector4d x = from_log_polar<double>(plain.y, now.sensor->position_m, now.sensor->velocity_mps);
      const Eigen::Matrix4d J = from_log_polar_jacobian<double>(plain.y);
      const Eigen::Matrix4d P = J * plain.P * J.transpose();
      ASSERT_LT((filter.x() - x).norm(), kManySteps * std::sqrt(P.trace())) << run << " " << k;
      ASSERT_LT((filter.P() - P).norm(), kManySteps * P.norm()) << run << " " << k;
    }
  }
}

TEST(LogPolarFilter, StepBeyondAllReasonFails) {
  // A bearing that is tied to the range by the prior, and off by half a circle of 57 standard deviations.
  Eigen::Matrix4d P = Eigen::Vector4d(1e6, 4e8, 1.0, 1.0).asDiagonal();
  P(0, 1) = P(1, 0) = 1.9e7;
  const Eigen::Vector4d x(0.0, 5000.0, 0.0, 0.0);
  LogPolarFilter<> filter(x, P);
  EXPECT_EQ(filter.update(Bearing<>{{0.0, 0.0}, {0.0, 0.0}, 0.01}, Vector1(3.1)).status, StepStatus::failed);
  EXPECT_EQ(filter.x(), x);
}

TEST(LogPolarFilter, TargetAtTheSensorFails) {
  LogPolarFilter<> filter({10.0, 20.0, 1.0, 1.0}, Eigen::Matrix4d::Identity());
  EXPECT_EQ(filter.update(Bearing<>{{10.0, 20.0}, {0.0, 0.0}, 0.02}, Vector1(1.0)).status, StepStatus::failed);
  EXPECT_EQ(filter.x(), Eigen::Vector4d(10.0, 20.0, 1.0, 1.0));
}

}  // namespace
}  // namespace truebearing::bearing_filters_test
