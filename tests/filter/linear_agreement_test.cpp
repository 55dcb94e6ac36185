// SPDX-License-Identifier: Apache-2.0
// On a linear problem every filter is the Kalman filter: one test for all of them, against the recursion written out.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <type_traits>

#include "tests/filter/linear_model.hpp"
#include "truebearing/core/random.hpp"
#include "truebearing/filter/kalman.hpp"
#include "truebearing/filter/unscented.hpp"
#include "truebearing/measurement/cartesian_position.hpp"
#include "truebearing/motion/constant_velocity.hpp"

namespace truebearing::linear_agreement_test {
namespace {

constexpr double kManySteps = 1e-9;

using Motion = ConstantVelocity<2, ContinuousWhiteNoise>;

template <typename FilterType, typename MotionType>
struct Path {
  using Filter = FilterType;
  using Motion = MotionType;
};

template <typename Path>
class LinearAgreement : public ::testing::Test {};
using Paths =
    ::testing::Types<Path<KalmanFilter<4, Joseph>, Motion>, Path<KalmanFilter<4, Conventional>, Motion>,
                     Path<KalmanFilter<4, SquareRoot>, Motion>, Path<KalmanFilter<4, Joseph>, AsNonlinear<Motion>>,
                     Path<KalmanFilter<4, SquareRoot>, AsNonlinear<Motion>>, Path<UnscentedKalmanFilter<4>, Motion>,
                     Path<UnscentedKalmanFilter<4>, AsNonlinear<Motion>>>;
TYPED_TEST_SUITE(LinearAgreement, Paths);

TYPED_TEST(LinearAgreement, WithTheRecursionOverIrregularSteps) {
  const Motion motion{{0.5}};
  const typename TypeParam::Motion path_motion{motion};
  const CartesianPosition<2> model{(Eigen::Matrix2d() << 25.0, -12.0, -12.0, 49.0).finished()};
  RandomStream random({24, Role::evaluation, 0}, StreamId::test);
  Eigen::Vector4d x(10.0, -20.0, 30.0, -4.0);
  Eigen::Matrix4d P = Eigen::Vector4d(400.0, 900.0, 25.0, 16.0).asDiagonal();
  typename TypeParam::Filter filter(x, P);
  double time_s = 0.0;
  for (int k = 0; k < 100; ++k) {
    const double dt_s = random.uniform(0.05, 4.0);
    time_s += dt_s;
    const double noise_1 = 5.0 * random.normal(), noise_2 = 7.0 * random.normal();
    const Eigen::Vector2d z(30.0 * time_s + noise_1, -4.0 * time_s + noise_2);
    ASSERT_EQ(filter.predict(path_motion, dt_s), StepStatus::ok);
    const auto update = filter.update(model, z);
    ASSERT_EQ(update.status, StepStatus::ok);

    const Eigen::Matrix4d F = motion.F(dt_s);
    x = F * x;
    P = F * P * F.transpose() + motion.Q(dt_s);
    const auto H = model.H(x);
    const Eigen::Matrix2d S = H * P * H.transpose() + model.R();
    const Eigen::Matrix<double, 4, 2> K = S.ldlt().solve(H * P).transpose();
    const Eigen::Vector2d nu = z - H * x;
    x += K * nu;
    P -= K * S * K.transpose();

    ASSERT_TRUE(filter.x().isApprox(x, kManySteps)) << "step " << k;
    ASSERT_TRUE(filter.P().isApprox(P, kManySteps)) << "step " << k;
    ASSERT_TRUE(update.S.isApprox(S, kManySteps)) << "step " << k;
    ASSERT_TRUE(update.K.isApprox(K, kManySteps)) << "step " << k;
    ASSERT_NEAR(update.nis, nu.dot(S.ldlt().solve(nu)), kManySteps * (1.0 + update.nis)) << "step " << k;
  }
}

}  // namespace
}  // namespace truebearing::linear_agreement_test
