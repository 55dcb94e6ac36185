// SPDX-License-Identifier: Apache-2.0
#include "truebearing/core/chi_square.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace truebearing::chi_square_test {
namespace {

TEST(ChiSquare, QuantilesMatchTables) {
  EXPECT_NEAR(chi_square_quantile(0.95, 1), 3.841459, 1e-6);
  EXPECT_NEAR(chi_square_quantile(0.95, 4), 9.487729, 1e-6);
  EXPECT_NEAR(chi_square_quantile(0.025, 10), 3.246973, 1e-6);
}

TEST(ChiSquare, TwoDegreesOfFreedomAreExponential) {
  for (const double p : {0.01, 0.5, 0.95, 0.9999})
    EXPECT_NEAR(chi_square_quantile(p, 2) / (-2.0 * std::log1p(-p)), 1.0, 1e-12) << p;
}

TEST(ChiSquare, MeansLieAsTheirSumDoes) {
  const ChiSquareMeans ten = chi_square_means(5.0, 2.0);
  EXPECT_NEAR(ten.low, 3.246973 / 5.0, 1e-6);
  EXPECT_NEAR(ten.high, 20.483177 / 5.0, 1e-6);
  EXPECT_TRUE(std::isnan(chi_square_means(0.0, 2.0).low));
}

TEST(ChiSquare, NormalQuantileIsItsRoot) {
  EXPECT_DOUBLE_EQ(normal_quantile(0.5), 0.0);
  EXPECT_NEAR(normal_quantile(0.975), 1.959963985, 1e-9);
  for (const double p : {0.6, 0.9, 0.999})
    EXPECT_NEAR(normal_quantile(p) * normal_quantile(p), chi_square_quantile(2.0 * p - 1.0, 1), 1e-10) << p;
}

}  // namespace
}  // namespace truebearing::chi_square_test
