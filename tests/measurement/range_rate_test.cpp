// SPDX-License-Identifier: Apache-2.0
#include "truebearing/measurement/range_rate.hpp"

#include <gtest/gtest.h>

#include "tests/support/jacobian.hpp"
#include "truebearing/core/covariance.hpp"
#include "truebearing/core/random.hpp"

namespace truebearing::range_rate_test {
namespace {

const RangeBearingRate<> kWhole{{100.0, 200.0}, {1.0, -2.0}, 50.0, 0.01, 0.5, 0.6};
const RangeRate kRate{{kWhole}};
const RangeAndRate kRangeAndRate{{kWhole}};

TEST(RangeRate, IsTheSpeedAlongTheSight) {
  const Eigen::Vector4d x(103.0, 204.0, 7.0, 8.0);
  EXPECT_NEAR(kRate.h(x)(0), 0.6 * 6.0 + 0.8 * 10.0, 1e-12);
  EXPECT_EQ(kRangeAndRate.h(x), Eigen::Vector2d(kWhole.h(x)(0), kWhole.h(x)(2)));
  EXPECT_EQ(kRate.R()(0), 0.25);
}

TEST(RangeRate, GoesWithTheRangeAsItIsTold) {
  const Eigen::Matrix2d R = kRangeAndRate.R();
  EXPECT_TRUE(R.isApprox(Eigen::Matrix2d{{2500.0, 0.6 * 25.0}, {0.6 * 25.0, 0.25}}, 1e-12));
  EXPECT_TRUE(is_covariance(kWhole.R()));
  EXPECT_EQ(kWhole.R()(0, 1), 0.0);
}

TEST(RangeRate, HasTheJacobianOfCentralDifferences) {
  RandomStream random({24, Role::evaluation, 0}, StreamId::test);
  for (int trial = 0; trial < 100; ++trial) {
    const Eigen::Vector4d x(random.normal() * 1e4, random.normal() * 1e4, random.normal() * 50, random.normal() * 50);
    const double length_m = 1e-4 * kWhole.h(x)(0);
    const Eigen::Vector4d step(length_m, length_m, 1e-3, 1e-3);
    const auto expected =
        testing::central_differences([](const Eigen::Vector4d& at) { return kRangeAndRate.h(at); }, x, step);
    for (int i = 0; i < 2; ++i)
      EXPECT_LT((kRangeAndRate.H(x).row(i) - expected.row(i)).norm(), 1e-6 * expected.row(i).norm()) << i;
    EXPECT_EQ(kRate.H(x), kRangeAndRate.H(x).bottomRows<1>());
  }
}

TEST(RangeRate, SaysNothingAtTheSite) {
  const Eigen::Vector4d x(100.0, 200.0, 7.0, 8.0);
  EXPECT_TRUE(kRangeAndRate.H(x).isZero(0.0));
  EXPECT_TRUE(kRate.H(x).isZero(0.0));
}

}  // namespace
}  // namespace truebearing::range_rate_test
