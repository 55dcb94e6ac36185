// SPDX-License-Identifier: Apache-2.0
#include "truebearing/filter/kalman.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <limits>

#include "tests/filter/linear_model.hpp"
#include "truebearing/core/constants.hpp"
#include "truebearing/core/covariance.hpp"
#include "truebearing/core/random.hpp"
#include "truebearing/measurement/position.hpp"
#include "truebearing/measurement/range_to_site.hpp"
#include "truebearing/motion/constant_velocity.hpp"

namespace truebearing::kalman_test {
namespace {

constexpr double kAlgebra = 1e-12;
constexpr double kManySteps = 1e-9;

using Vector1d = Eigen::Matrix<double, 1, 1>;

const Eigen::Vector4d kX0(10.0, -20.0, 3.0, 4.0);
const Eigen::Matrix4d kP0 = Eigen::Vector4d(400.0, 900.0, 25.0, 16.0).asDiagonal();

template <typename Derived>
void fill_normal(RandomStream& random, Eigen::MatrixBase<Derived>& A) {
  for (Eigen::Index j = 0; j < A.cols(); ++j)
    for (Eigen::Index i = 0; i < A.rows(); ++i) A(i, j) = random.normal();
}

template <typename Form>
class KalmanFilterForms : public ::testing::Test {};
using Forms = ::testing::Types<Joseph, Conventional, SquareRoot>;
TYPED_TEST_SUITE(KalmanFilterForms, Forms);

TYPED_TEST(KalmanFilterForms, AgreeWithTheTextbookOnALinearProblem) {
  const ConstantVelocity<2, ContinuousWhiteNoise> motion{{0.5}};
  const Position<2> model{{5.0, 7.0}};
  RandomStream random({2, Role::evaluation, 0}, StreamId::test);
  KalmanFilter<4, TypeParam> filter(kX0, kP0);
  Eigen::Vector4d x = kX0;
  Eigen::Matrix4d P = kP0;
  for (int k = 0; k < 200; ++k) {
    const Eigen::Vector2d z(30.0 * k + 5.0 * random.normal(), -4.0 * k + 7.0 * random.normal());
    ASSERT_EQ(filter.predict(motion, 2.0), StepStatus::ok);
    const auto update = filter.update(model, z);
    ASSERT_EQ(update.status, StepStatus::ok);

    const Eigen::Matrix4d F = motion.F(2.0);
    x = F * x;
    P = F * P * F.transpose() + motion.Q(2.0);
    const auto H = model.H(x);
    const Eigen::Matrix2d S = H * P * H.transpose() + model.R();
    const Eigen::Matrix<double, 4, 2> K = S.ldlt().solve(H * P).transpose();
    const Eigen::Vector2d nu = z - H * x;
    x += K * nu;
    P = P - K * S * K.transpose();

    const double tolerance = k == 0 ? kAlgebra : kManySteps;
    ASSERT_TRUE(filter.x().isApprox(x, tolerance)) << "step " << k;
    ASSERT_TRUE(filter.P().isApprox(P, tolerance)) << "step " << k;
    ASSERT_TRUE(update.S.isApprox(S, tolerance));
    ASSERT_TRUE(update.K.isApprox(K, tolerance));
    ASSERT_NEAR(update.nis, nu.dot(S.ldlt().solve(nu)), tolerance * (1.0 + update.nis));
  }
}

TYPED_TEST(KalmanFilterForms, SequentialEqualsBatchForIndependentMeasurements) {
  LinearMeasurement<4, 2> both;
  both.jacobian << 1.0, 0.5, 0.0, 2.0, 0.0, 1.0, -1.0, 0.3;
  both.noise = Eigen::Vector2d(4.0, 9.0).asDiagonal();
  const Eigen::Vector2d z(12.0, -7.0);
  KalmanFilter<4, TypeParam> batch(kX0, kP0), sequential(kX0, kP0);
  ASSERT_EQ(batch.update(both, z).status, StepStatus::ok);
  for (int i = 0; i < 2; ++i) {
    const LinearMeasurement<4, 1> one{both.jacobian.row(i), Vector1d(both.noise(i, i))};
    ASSERT_EQ(sequential.update(one, Vector1d(z(i))).status, StepStatus::ok);
  }
  EXPECT_TRUE(sequential.x().isApprox(batch.x(), kAlgebra));
  EXPECT_TRUE(sequential.P().isApprox(batch.P(), kAlgebra));
}

TYPED_TEST(KalmanFilterForms, MeasurementOfInfiniteVarianceChangesNothing) {
  KalmanFilter<4, TypeParam> filter(kX0, kP0);
  const Eigen::Matrix4d P = filter.P();
  ASSERT_EQ(filter.update(Position<2>{{1e100, 1e100}}, Eigen::Vector2d(1e3, 1e3)).status, StepStatus::ok);
  EXPECT_TRUE(filter.x().isApprox(kX0, kAlgebra));
  EXPECT_TRUE(filter.P().isApprox(P, kAlgebra));
}

TYPED_TEST(KalmanFilterForms, PredictionOverPartsEqualsPredictionOverTheWhole) {
  const ConstantVelocity<2, ContinuousWhiteNoise> motion{{0.5}};
  KalmanFilter<4, TypeParam> parts(kX0, kP0), whole(kX0, kP0);
  parts.predict(motion, 0.7);
  parts.predict(motion, 1.9);
  whole.predict(motion, 2.6);
  EXPECT_TRUE(parts.x().isApprox(whole.x(), kAlgebra));
  EXPECT_TRUE(parts.P().isApprox(whole.P(), kAlgebra));
}

TYPED_TEST(KalmanFilterForms, NoTimeChangesNothingToTheBit) {
  KalmanFilter<4, TypeParam> filter(kX0, kP0);
  filter.predict(ConstantVelocity<2, ContinuousWhiteNoise>{{0.5}}, 1.0);
  const Eigen::Vector4d x = filter.x();
  const Eigen::Matrix4d P = filter.P();
  EXPECT_EQ(filter.predict(ConstantVelocity<2, ContinuousWhiteNoise>{{0.5}}, 0.0), StepStatus::ok);
  EXPECT_EQ(filter.x(), x);
  EXPECT_EQ(filter.P(), P);
}

TYPED_TEST(KalmanFilterForms, CovarianceStaysValidOverRandomProblems) {
  RandomStream random({3, Role::evaluation, 0}, StreamId::test);
  for (int problem = 0; problem < 200; ++problem) {
    Eigen::Matrix4d A;
    fill_normal(random, A);
    A.col(3).setZero();  // a singular start
    LinearMotion<4> motion;
    fill_normal(random, motion.transition);
    motion.transition *= 0.6;
    const Eigen::Matrix<double, 4, 1> direction = A.col(0);
    motion.noise = direction * direction.transpose();  // and a singular process noise
    LinearMeasurement<4, 2> model;
    fill_normal(random, model.jacobian);
    const double sigma = std::pow(10.0, random.uniform(-2.0, 2.0));
    model.noise = sigma * sigma * Eigen::Matrix2d::Identity();
    KalmanFilter<4, TypeParam> filter(kX0, A * A.transpose());
    for (int k = 0; k < 20; ++k) {
      ASSERT_EQ(filter.predict(motion, 1.0), StepStatus::ok) << "problem " << problem << " step " << k;
      ASSERT_TRUE(is_covariance(filter.P()));
      ASSERT_EQ(filter.update(model, {random.normal(), random.normal()}).status, StepStatus::ok)
          << "problem " << problem << " step " << k;
      ASSERT_TRUE(is_covariance(filter.P()));
      ASSERT_EQ(filter.P(), filter.P().transpose().eval());
    }
  }
}

TYPED_TEST(KalmanFilterForms, FailedUpdateLeavesTheStateAlone) {
  KalmanFilter<2, TypeParam> filter({1.0, 2.0}, Eigen::Matrix2d::Identity());
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
}

TYPED_TEST(KalmanFilterForms, FailedPredictionLeavesTheStateAlone) {
  KalmanFilter<2, TypeParam> filter({1.0, 2.0}, Eigen::Matrix2d::Identity());
  const Eigen::Matrix2d P = filter.P();
  EXPECT_EQ(filter.predict(ConstantVelocity<1, ContinuousWhiteNoise>{{1.0}}, kNaN), StepStatus::failed);
  EXPECT_EQ(filter.predict(ConstantVelocity<1, ContinuousWhiteNoise>{{-100.0}}, 1.0), StepStatus::failed);
  EXPECT_EQ(filter.x(), Eigen::Vector2d(1.0, 2.0));
  EXPECT_EQ(filter.P(), P);
}

TYPED_TEST(KalmanFilterForms, StateThatLeavesItsRangeFailsInWhicheverComponentItDoes) {
  const double most = std::numeric_limits<double>::max();
  const LinearMotion<3> growth{10.0 * Eigen::Matrix3d::Identity(), Eigen::Matrix3d::Identity()};
  for (const Eigen::Vector3d& x0 :
       {Eigen::Vector3d(most, 1.0, 1.0), {1.0, -most, 1.0}, {1.0, 1.0, most}, {1.0, most, -most}, {most, most, most}}) {
    KalmanFilter<3, TypeParam> filter(x0, Eigen::Matrix3d::Identity());
    EXPECT_EQ(filter.predict(growth, 1.0), StepStatus::failed) << x0;
    EXPECT_EQ(filter.x(), x0);
    EXPECT_EQ(filter.predict(LinearMotion<3>{Eigen::Matrix3d::Identity(), growth.noise}, 1.0), StepStatus::ok) << x0;
    EXPECT_EQ(filter.x(), x0);
  }
}

TYPED_TEST(KalmanFilterForms, IndefiniteStartFailsAtEveryStep) {
  Eigen::Matrix2d P0;
  P0 << 1.0, 2.0, 2.0, 1.0;
  KalmanFilter<2, TypeParam> filter({0.0, 0.0}, P0);
  EXPECT_EQ(filter.predict(ConstantVelocity<1, ContinuousWhiteNoise>{{1.0}}, 1.0), StepStatus::failed);
  EXPECT_EQ(filter.update(Position<1>{Vector1d(1.0)}, Vector1d(0.0)).status, StepStatus::failed);
}

TYPED_TEST(KalmanFilterForms, NothingKnownAndNothingMeasuredFails) {
  KalmanFilter<2, TypeParam> filter({0.0, 0.0}, Eigen::Matrix2d::Zero());
  EXPECT_EQ(filter.update(Position<1>{Vector1d(0.0)}, Vector1d(0.0)).status, StepStatus::failed);
}

TYPED_TEST(KalmanFilterForms, RangeUpdateIsTheExtendedFilters) {
  const RangeToSite<> model{{-500.0, 300.0}, 10.0};
  KalmanFilter<4, TypeParam> filter(kX0, kP0), linearised(kX0, kP0);
  const Vector1d z(620.0);
  ASSERT_EQ(filter.update(model, z).status, StepStatus::ok);
  const LinearMeasurement<4, 1> tangent{model.H(kX0), model.R()};
  linearised.update(tangent, z - model.h(kX0) + tangent.h(kX0));
  EXPECT_TRUE(filter.x().isApprox(linearised.x(), kAlgebra));
  EXPECT_TRUE(filter.P().isApprox(linearised.P(), kAlgebra));
}

TYPED_TEST(KalmanFilterForms, FloatFollowsDouble) {
  KalmanFilter<2, TypeParam, float> single({0.0F, 1.0F}, Eigen::Matrix2f::Identity());
  KalmanFilter<2, TypeParam> exact({0.0, 1.0}, Eigen::Matrix2d::Identity());
  for (int k = 1; k <= 50; ++k) {
    ASSERT_EQ(single.predict(ConstantVelocity<1, ContinuousWhiteNoise, float>{{0.1}}, 1.0F), StepStatus::ok);
    exact.predict(ConstantVelocity<1, ContinuousWhiteNoise>{{0.1}}, 1.0);
    const float z = static_cast<float>(k);
    ASSERT_EQ(single.update(Position<1, float>{Eigen::Matrix<float, 1, 1>(2.0F)}, Eigen::Matrix<float, 1, 1>(z)).status,
              StepStatus::ok);
    exact.update(Position<1>{Vector1d(2.0)}, Vector1d(k));
  }
  EXPECT_TRUE(single.x().template cast<double>().isApprox(exact.x(), 1e-5));
  EXPECT_TRUE(single.P().template cast<double>().isApprox(exact.P(), 1e-5));
}

}  // namespace
}  // namespace truebearing::kalman_test
