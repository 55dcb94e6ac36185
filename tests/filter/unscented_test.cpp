// SPDX-License-Identifier: Apache-2.0
#include "truebearing/filter/unscented.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/filter/linear_model.hpp"
#include "truebearing/core/angle.hpp"
#include "truebearing/core/chi_square.hpp"
#include "truebearing/core/constants.hpp"
#include "truebearing/core/covariance.hpp"
#include "truebearing/core/random.hpp"
#include "truebearing/measurement/longer_state.hpp"
#include "truebearing/measurement/position.hpp"
#include "truebearing/measurement/range_bearing.hpp"
#include "truebearing/measurement/range_to_site.hpp"
#include "truebearing/motion/constant_velocity.hpp"
#include "truebearing/motion/turning_target.hpp"

namespace truebearing::unscented_test {
namespace {

constexpr double kAlgebra = 1e-12;
constexpr double kManySteps = 1e-9;

using Vector1d = Eigen::Matrix<double, 1, 1>;
using Turning = TurningTarget<ContinuousWhiteNoise>;
using State5 = Eigen::Matrix<double, 5, 1>;
using Matrix5 = Eigen::Matrix<double, 5, 5>;

TEST(UnscentedKalmanFilter, SeesThatSpreadAcrossTheSightLineLengthensTheRange) {
  const Eigen::Vector4d x0(0.0, 1000.0, 0.0, 0.0);
  UnscentedKalmanFilter<4> filter(x0, Eigen::Vector4d(100.0 * 100.0, 1.0, 1.0, 1.0).asDiagonal());
  const auto update = filter.update(RangeToSite<>{{0.0, 0.0}, 10.0}, Vector1d(1000.0));
  ASSERT_EQ(update.status, StepStatus::ok);
  // E |p| = 1000 + 100^2 / 2000 m, up to terms of the order (100 / 1000)^2 of the correction.
  EXPECT_NEAR(update.nu(0), -5.0, 0.01 * 5.0);
}

TEST(UnscentedKalmanFilter, BearingsMayWrapAmongThePoints) {
  // The same problem North and, turned by half a circle, South of the site, where bearings jump from pi to -pi.
  const RangeBearing<> model{{0.0, 0.0}, 20.0, 0.05};
  const Eigen::Vector4d x0(5.0, 900.0, -3.0, 2.0);
  const Eigen::Matrix4d P0 = Eigen::Vector4d(100.0 * 100.0, 80.0 * 80.0, 25.0, 25.0).asDiagonal();
  UnscentedKalmanFilter<4> north(x0, P0), south(-x0, P0);
  const Eigen::Vector2d z(930.0, 0.03);
  ASSERT_EQ(north.update(model, z).status, StepStatus::ok);
  ASSERT_EQ(south.update(model, {z(0), z(1) - kPi}).status, StepStatus::ok);
  EXPECT_TRUE(south.x().isApprox(-north.x(), kManySteps));
  EXPECT_TRUE(south.P().isApprox(north.P(), kManySteps));

  UnscentedKalmanFilter<4> turned(-x0, P0);
  ASSERT_EQ(turned.update(model, {z(0), z(1) + 5 * kPi}).status, StepStatus::ok);
  EXPECT_TRUE(turned.x().isApprox(south.x(), kManySteps));
}

TEST(UnscentedKalmanFilter, CertaintyIsMovedByTheModelItself) {
  const State5 x0 = (State5() << 4000.0, -2500.0, 120.0, -90.0, 0.05).finished();
  UnscentedKalmanFilter<5> filter(x0, Matrix5::Zero());
  const Turning motion{{2.0}, 0.01};
  ASSERT_EQ(filter.predict(motion, 2.0), StepStatus::ok);
  EXPECT_EQ(filter.x(), motion.f(x0, 2.0));
  EXPECT_EQ(filter.P(), motion.Q(2.0));
}

TEST(UnscentedKalmanFilter, FloatFollowsDouble) {
  UnscentedKalmanFilter<2, float> single({0.0F, 1.0F}, Eigen::Matrix2f::Identity());
  UnscentedKalmanFilter<2> exact({0.0, 1.0}, Eigen::Matrix2d::Identity());
  using Straight = ConstantVelocity<1, ContinuousWhiteNoise>;
  using SingleStraight = ConstantVelocity<1, ContinuousWhiteNoise, float>;
  for (int k = 1; k <= 50; ++k) {
    ASSERT_EQ(single.predict(AsNonlinear<SingleStraight>{{{0.1}}}, 1.0F), StepStatus::ok);
    ASSERT_EQ(exact.predict(AsNonlinear<Straight>{{{0.1}}}, 1.0), StepStatus::ok);
    const Eigen::Matrix<float, 1, 1> z(static_cast<float>(k));
    ASSERT_EQ(single.update(Position<1, float>{Eigen::Matrix<float, 1, 1>(2.0F)}, z).status, StepStatus::ok);
    ASSERT_EQ(exact.update(Position<1>{Vector1d(2.0)}, Vector1d(k)).status, StepStatus::ok);
  }
  EXPECT_TRUE(single.x().cast<double>().isApprox(exact.x(), 1e-4));
  EXPECT_TRUE(single.P().cast<double>().isApprox(exact.P(), 1e-4));
}

TEST(UnscentedKalmanFilter, CovarianceStaysValidOverRandomProblems) {
  RandomStream random({25, Role::evaluation, 0}, StreamId::test);
  const auto fill_normal = [&](auto& A) {
    for (Eigen::Index j = 0; j < A.cols(); ++j)
      for (Eigen::Index i = 0; i < A.rows(); ++i) A(i, j) = random.normal();
  };
  for (int problem = 0; problem < 200; ++problem) {
    Eigen::Matrix4d A;
    fill_normal(A);
    A.col(3).setZero();  // a singular start
    AsNonlinear<LinearMotion<4>> motion;
    fill_normal(motion.motion.transition);
    motion.motion.transition *= 0.6;
    motion.motion.noise = A.col(0) * A.col(0).transpose();  // and a singular process noise
    LinearMeasurement<4, 2> model;
    fill_normal(model.jacobian);
    const double sigma = std::pow(10.0, random.uniform(-2.0, 2.0));
    model.noise = sigma * sigma * Eigen::Matrix2d::Identity();
    UnscentedKalmanFilter<4> filter(Eigen::Vector4d(10.0, -20.0, 3.0, 4.0), A * A.transpose());
    for (int k = 0; k < 20; ++k) {
      ASSERT_EQ(filter.predict(motion, 1.0), StepStatus::ok) << "problem " << problem << " step " << k;
      ASSERT_TRUE(is_covariance(filter.P()));
      const double z_1 = random.normal(), z_2 = random.normal();
      ASSERT_EQ(filter.update(model, {z_1, z_2}).status, StepStatus::ok) << "problem " << problem << " step " << k;
      ASSERT_TRUE(is_covariance(filter.P()));
      ASSERT_EQ(filter.P(), filter.P().transpose().eval());
    }
  }
}

TEST(UnscentedKalmanFilter, FailedStepLeavesTheStateAlone) {
  UnscentedKalmanFilter<2> filter({1.0, 2.0}, Eigen::Matrix2d::Identity());
  const Eigen::Vector2d x = filter.x();
  const Eigen::Matrix2d P = filter.P();
  const Eigen::RowVector2d H(1.0, 0.0);
  const double infinity = std::numeric_limits<double>::infinity();
  for (const auto& [z, R] :
       {std::pair(kNaN, 1.0), {infinity, 1.0}, {0.0, kNaN}, {0.0, infinity}, {0.0, -0.5}, {0.0, -2.0}}) {
    const auto update = filter.update(LinearMeasurement<2, 1>{H, Vector1d(R)}, Vector1d(z));
    EXPECT_EQ(update.status, StepStatus::failed) << "z " << z << ", R " << R;
    EXPECT_EQ(filter.x(), x);
    EXPECT_EQ(filter.P(), P);
  }
  using Straight = ConstantVelocity<1, ContinuousWhiteNoise>;
  EXPECT_EQ(filter.predict(Straight{{1.0}}, kNaN), StepStatus::failed);
  EXPECT_EQ(filter.predict(AsNonlinear<Straight>{{{1.0}}}, kNaN), StepStatus::failed);
  EXPECT_EQ(filter.predict(AsNonlinear<Straight>{{{-100.0}}}, 1.0), StepStatus::failed);
  EXPECT_EQ(filter.x(), x);
  EXPECT_EQ(filter.P(), P);
}

TEST(UnscentedKalmanFilter, IndefiniteStartFailsAtEveryStep) {
  Eigen::Matrix2d P0;
  P0 << 1.0, 2.0, 2.0, 1.0;
  UnscentedKalmanFilter<2> filter({0.0, 0.0}, P0);
  using Straight = ConstantVelocity<1, ContinuousWhiteNoise>;
  EXPECT_EQ(filter.predict(Straight{{1.0}}, 1.0), StepStatus::failed);
  EXPECT_EQ(filter.predict(AsNonlinear<Straight>{{{1.0}}}, 1.0), StepStatus::failed);
  EXPECT_EQ(filter.update(Position<1>{Vector1d(1.0)}, Vector1d(0.0)).status, StepStatus::failed);
}

TEST(UnscentedKalmanFilter, NothingKnownAndNothingMeasuredFails) {
  UnscentedKalmanFilter<2> filter({0.0, 0.0}, Eigen::Matrix2d::Zero());
  EXPECT_EQ(filter.update(Position<1>{Vector1d(0.0)}, Vector1d(0.0)).status, StepStatus::failed);
}

TEST(UnscentedKalmanFilter, MeasurementOfInfiniteVarianceChangesNothing) {
  const Eigen::Vector2d x0(1.0, 2.0);
  UnscentedKalmanFilter<2> filter(x0, Eigen::Matrix2d::Identity());
  ASSERT_EQ(filter.update(Position<1>{Vector1d(1e100)}, Vector1d(1e3)).status, StepStatus::ok);
  EXPECT_TRUE(filter.x().isApprox(x0, kAlgebra));
  EXPECT_TRUE(filter.P().isApprox(Eigen::Matrix2d::Identity(), kAlgebra));
}

constexpr int kRuns = 200;

/// Sum over runs of the NEES at the last step of a turning target seen in range and bearing; chi-square with 5 kRuns
/// degrees of freedom for a filter that knows the truth's process noise.
double nees_sum(double noise_factor) {
  constexpr int kSteps = 40;
  const double dt_s = 2.0;
  const Turning truth_motion{{1.0}, 0.002};
  const Turning motion{{noise_factor}, 0.002 * std::sqrt(noise_factor)};
  const RangeBearing<> polar{{0.0, 0.0}, 20.0, radians(0.5)};
  const auto model = on_state<5>(polar);
  const State5 x0 = (State5() << -4000.0, 5000.0, 80.0, 30.0, 0.03).finished();
  const State5 sigma = (State5() << 100.0, 100.0, 10.0, 10.0, 0.01).finished();
  const Matrix5 P0 = sigma.cwiseAbs2().asDiagonal();
  const Matrix5 process = semidefinite_root<5, double>(truth_motion.Q(dt_s));
  double sum = 0.0;
  for (int run = 0; run < kRuns; ++run) {
    RandomStream random({26, Role::evaluation, static_cast<std::uint64_t>(run)}, StreamId::test);
    const auto draw = [&] {
      State5 w;
      for (int i = 0; i < 5; ++i) w(i) = random.normal();
      return w;
    };
    State5 truth = x0 + sigma.cwiseProduct(draw());
    UnscentedKalmanFilter<5> filter(x0, P0);
    for (int k = 0; k < kSteps; ++k) {
      truth = (truth_motion.f(truth, dt_s) + process * draw()).eval();
      const double range_noise_m = polar.sigma_range_m * random.normal();
      const Eigen::Vector2d noise(range_noise_m, polar.sigma_bearing_rad * random.normal());
      EXPECT_EQ(filter.predict(motion, dt_s), StepStatus::ok);
      EXPECT_EQ(filter.update(model, model.h(truth) + noise).status, StepStatus::ok);
    }
    sum += mahalanobis_squared(filter.P(), truth - filter.x());
  }
  return sum;
}

// Two-sided interval at 99.9 %: a correct filter fails one seed in a thousand.
const double kLow = chi_square_quantile(0.0005, 5.0 * kRuns);
const double kHigh = chi_square_quantile(0.9995, 5.0 * kRuns);

TEST(UnscentedKalmanFilterConsistency, NeesIsChiSquareForATurningTarget) {
  const double sum = nees_sum(1.0);
  EXPECT_GT(sum, kLow);
  EXPECT_LT(sum, kHigh);
}

TEST(UnscentedKalmanFilterConsistency, MistunedFiltersAreCaught) {
  EXPECT_GT(nees_sum(0.2), kHigh);
  EXPECT_LT(nees_sum(5.0), kLow);
}

}  // namespace
}  // namespace truebearing::unscented_test
