// SPDX-License-Identifier: Apache-2.0
// The Kalman filter across a nonlinear motion.
#include <gtest/gtest.h>

#include <limits>

#include "truebearing/filter/kalman.hpp"
#include "truebearing/motion/turning_target.hpp"

namespace truebearing::extended_kalman_test {
namespace {

constexpr double kAlgebra = 1e-12;

const TurningTarget<ContinuousWhiteNoise> kMotion{{2.0}, 0.01};

template <typename Form>
class ExtendedKalmanFilter : public ::testing::Test {};
using Forms = ::testing::Types<Joseph, SquareRoot>;
TYPED_TEST_SUITE(ExtendedKalmanFilter, Forms);

TYPED_TEST(ExtendedKalmanFilter, PredictsByTheJacobianAtTheEstimateBefore) {
  using Filter = KalmanFilter<5, TypeParam>;
  const auto x0 = (typename Filter::State() << 4000.0, -2500.0, 120.0, -90.0, 0.05).finished();
  const auto sigma = (typename Filter::State() << 100.0, 80.0, 10.0, 12.0, 0.02).finished();
  const typename Filter::Covariance P0 = sigma.cwiseAbs2().asDiagonal();
  Filter filter(x0, P0);
  ASSERT_EQ(filter.predict(kMotion, 2.0), StepStatus::ok);
  const typename Filter::Covariance F = kMotion.F(x0, 2.0);
  EXPECT_EQ(filter.x(), kMotion.f(x0, 2.0));
  EXPECT_TRUE(filter.P().isApprox(F * P0 * F.transpose() + kMotion.Q(2.0), kAlgebra));

  const typename Filter::State x = filter.x();
  const typename Filter::Covariance P = filter.P();
  EXPECT_EQ(filter.predict(kMotion, std::numeric_limits<double>::quiet_NaN()), StepStatus::failed);
  EXPECT_EQ(filter.x(), x);
  EXPECT_EQ(filter.P(), P);
}

}  // namespace
}  // namespace truebearing::extended_kalman_test
