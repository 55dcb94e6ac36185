// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tma/cho_2015.hpp"

#include <gtest/gtest.h>

#include "tests/support/bearing_runs.hpp"

namespace truebearing::cho_2015_test {
namespace {

using testing::data_scenario;
using testing::two_legs;
using testing::window_of;
using Method = ChoOptions::Method;

const Eigen::Vector4d kTarget(3000.0, 5000.0, -2.0, 1.0);

ChoOptions options(Method method) {
  ChoOptions o;
  o.method = method;
  return o;
}

TEST(Cho2015, StartsLieOnTheFirstAndTheLastBearing) {
  const BearingWindow window = two_legs(kTarget, 300.0, 600.0, 1.0);
  EXPECT_EQ(kChoStarts, 225);
  for (int i = 0; i < kChoStarts; i += 7) {
    const Eigen::Vector4d x = cho_start(window, i);
    EXPECT_NEAR(window.residual(0, x, 0.0), 0.0, 1e-12);
    EXPECT_NEAR(window.residual(window.size() - 1, x, 0.0), 0.0, 1e-12);
  }
  const Eigen::Vector4d x = cho_start(window, 15 * 3 + 6);  // 4 km and 7 km
  const std::size_t last = window.size() - 1;
  EXPECT_NEAR((x.head<2>() - window.site_m(0)).norm(), 4000.0, 1e-9);
  EXPECT_NEAR((x.head<2>() + 600.0 * x.tail<2>() - window.site_m(last)).norm(), 7000.0, 1e-9);
}

TEST(Cho2015, GaussNewtonFindsTheTargetOfExactBearings) {
  const BatchEstimate estimate = solve_cho(two_legs(kTarget, 300.0, 600.0), options(Method::gauss_newton));
  ASSERT_TRUE(estimate.found);
  Eigen::Vector4d expected = kTarget;
  expected.head<2>() += 600.0 * kTarget.tail<2>();
  EXPECT_LT((estimate.x - expected).norm(), 1e-3);
  EXPECT_EQ(estimate.starts, 225);
  EXPECT_EQ(estimate.time_s, 600.0);
}

// The paper's table 1: damping keeps every start finite, plain inversion does not.
TEST(Cho2015, DampedStartsStayFiniteAndGaussNewtonsDoNot) {
  const BearingWindow window = window_of(data_scenario("cho_s1")->simulate({1, Role::evaluation, 0}), 280.0);
  EXPECT_EQ(solve_cho(window, options(Method::levenberg)).non_finite_starts, 0);
  EXPECT_EQ(solve_cho(window, options(Method::levenberg_marquardt)).non_finite_starts, 0);
  ChoOptions gauss_newton = options(Method::gauss_newton);
  EXPECT_GT(solve_cho(window, gauss_newton).non_finite_starts, 20);
  gauss_newton.inverse = ChoOptions::Inverse::cofactor_float;
  EXPECT_GT(solve_cho(window, gauss_newton).non_finite_starts, 50);
  gauss_newton.inverse = ChoOptions::Inverse::pivoted;
  EXPECT_EQ(solve_cho(window, gauss_newton).non_finite_starts, 0);
}

TEST(Cho2015, StopsAfterTenSteps) {
  const BatchEstimate estimate = solve_cho(two_legs(kTarget, 300.0, 600.0, 1.0), options(Method::levenberg));
  EXPECT_EQ(estimate.iterations, 10);
}

}  // namespace
}  // namespace truebearing::cho_2015_test
