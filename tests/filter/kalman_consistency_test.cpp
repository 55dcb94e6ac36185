// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "truebearing/core/chi_square.hpp"
#include "truebearing/core/covariance.hpp"
#include "truebearing/core/random.hpp"
#include "truebearing/filter/kalman.hpp"
#include "truebearing/measurement/position.hpp"
#include "truebearing/motion/constant_velocity.hpp"

namespace truebearing::kalman_consistency_test {
namespace {

constexpr int kRuns = 400;
constexpr int kSteps = 50;

/// Sum over runs of the NEES at the last step; chi-square with 2 kRuns degrees of freedom for a filter that knows the
/// truth's process noise.
double nees_sum(double filter_density) {
  const ConstantVelocity<1, ContinuousWhiteNoise> truth_motion{{1.0}}, motion{{filter_density}};
  const Position<1> model{Eigen::Matrix<double, 1, 1>(10.0)};
  const Eigen::Matrix2d P0 = Eigen::Vector2d(100.0, 25.0).asDiagonal();
  const Eigen::Matrix2d process = truth_motion.Q(1.0).llt().matrixL();
  double sum = 0.0;
  for (int run = 0; run < kRuns; ++run) {
    RandomStream random({4, Role::evaluation, static_cast<std::uint64_t>(run)}, StreamId::test);
    const double position_m = 10.0 * random.normal(), velocity_mps = 5.0 * random.normal();
    Eigen::Vector2d truth(position_m, velocity_mps);
    KalmanFilter<2> filter(Eigen::Vector2d::Zero(), P0);
    for (int k = 0; k < kSteps; ++k) {
      const double w1 = random.normal(), w2 = random.normal();
      truth = (truth_motion.F(1.0) * truth + process * Eigen::Vector2d(w1, w2)).eval();
      filter.predict(motion, 1.0);
      filter.update(model, Eigen::Matrix<double, 1, 1>(truth(0) + 10.0 * random.normal()));
    }
    sum += mahalanobis_squared(filter.P(), truth - filter.x());
  }
  return sum;
}

// Two-sided interval at 99.9 %: a correct filter fails one seed in a thousand.
const double kLow = chi_square_quantile(0.0005, 2.0 * kRuns);
const double kHigh = chi_square_quantile(0.9995, 2.0 * kRuns);

TEST(KalmanFilterConsistency, NeesIsChiSquare) {
  const double sum = nees_sum(1.0);
  EXPECT_GT(sum, kLow);
  EXPECT_LT(sum, kHigh);
}

TEST(KalmanFilterConsistency, MistunedFiltersAreCaught) {
  EXPECT_GT(nees_sum(0.3), kHigh);
  EXPECT_LT(nees_sum(3.0), kLow);
}

}  // namespace
}  // namespace truebearing::kalman_consistency_test
