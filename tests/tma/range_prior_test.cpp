// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tma/range_prior.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "truebearing/core/angle.hpp"
#include "truebearing/core/covariance.hpp"

namespace truebearing::range_prior_test {
namespace {

// Moments by summation over a fine grid.
TruncatedNormal summed(double mean, double sigma, double low, double high) {
  constexpr int kCells = 200000;
  double s0 = 0.0, s1 = 0.0, s2 = 0.0;
  for (int i = 0; i < kCells; ++i) {
    const double x = low + (i + 0.5) * (high - low) / kCells, u = (x - mean) / sigma;
    const double p = std::exp(-0.5 * u * u);
    s0 += p;
    s1 += p * x;
    s2 += p * x * x;
  }
  const double m = s1 / s0;
  return {m, std::sqrt(s2 / s0 - m * m), s0 * (high - low) / kCells / (sigma * std::sqrt(2.0 * kPi))};
}

TEST(TruncatedNormal, HasTheMomentsOfWhatIsLeft) {
  for (const double mean : {-2000.0, 1000.0, 6000.0, 9000.0, 16000.0, 25000.0}) {
    const TruncatedNormal formula = truncated_normal(mean, 3000.0, 3000.0, 15000.0);
    const TruncatedNormal sum = summed(mean, 3000.0, 3000.0, 15000.0);
    EXPECT_NEAR(formula.mean, sum.mean, 0.01) << mean;
    EXPECT_NEAR(formula.sigma, sum.sigma, 0.01) << mean;
    EXPECT_NEAR(formula.mass / sum.mass, 1.0, 1e-6) << mean;
  }
}

TEST(TruncatedNormal, FarOutsideIsTheNearerEnd) {
  EXPECT_EQ(truncated_normal(1e6, 100.0, 3000.0, 15000.0).mean, 15000.0);
  EXPECT_EQ(truncated_normal(-1e6, 100.0, 3000.0, 15000.0).mean, 3000.0);
}

TEST(RangePrior, LiesAlongTheBearingFromTheSensor) {
  RangePrior prior;
  prior.range_m = 6000.0;
  prior.range_sigma_m = 2000.0;
  prior.velocity_sigma_mps = 4.0;
  const SensorState sensor{{100.0, -50.0}, {3.0, 0.0}};
  const GaussianState state = prior.state(radians(90.0), radians(1.0), sensor, std::nullopt);
  EXPECT_NEAR(state.x[0], 6100.0, 1e-9);
  EXPECT_NEAR(state.x[1], -50.0, 1e-9);
  EXPECT_NEAR(std::sqrt(state.P(0, 0)), 2000.0, 1e-6);
  EXPECT_NEAR(std::sqrt(state.P(1, 1)), std::hypot(6000.0, 2000.0) * radians(1.0), 1e-6);
  EXPECT_NEAR(state.P(2, 2), 16.0, 1e-12);
  EXPECT_TRUE(is_covariance(state.P));
}

TEST(RangePrior, GuessComesBeforeItsOwnNumbersAndIsCutToTheFamily) {
  RangePrior prior;
  prior.between = RangePrior::Interval{3000.0, 15000.0};
  const TruncatedNormal believed = prior.range(TargetGuess{14500.0, 3000.0});
  EXPECT_LT(believed.mean, 13500.0);
  EXPECT_LT(believed.sigma, 2500.0);
}

TEST(RangePrior, CourseIsRelativeToTheBearing) {
  RangePrior prior;
  prior.range_m = 5000.0;
  prior.range_sigma_m = 2000.0;
  prior.course = RangePrior::Course{2.0, 1.0, kPi, 0.9};
  const GaussianState state = prior.state(radians(80.0), radians(1.5), {}, std::nullopt);
  EXPECT_NEAR(state.x[2], 2.0 * std::sin(radians(260.0)), 1e-12);
  EXPECT_NEAR(state.x[3], 2.0 * std::cos(radians(260.0)), 1e-12);
  EXPECT_TRUE(is_covariance(state.P));
}

}  // namespace
}  // namespace truebearing::range_prior_test
