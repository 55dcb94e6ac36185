// SPDX-License-Identifier: Apache-2.0
// Friedland's separate-bias estimation (IEEE Trans. Automatic Control AC-14, 1969), against the companion that features
// compare with. The error b of the base's prior mean is a constant bias, b ~ N(0, M). It reaches the base's errors
// through
//     U <- F U,  s = H U,  U <- (I - K H) U,   U_0 = I,
// so the base's innovations have mean s b, and its information form estimates it: I <- I + s' S^-1 s, i <- i + s' S^-1
// nu, I_0 = M^-1. The filter that starts with P0 + M must then say x_base + U I^-1 i, with covariance P_base + U I^-1
// U'.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "tests/support/line_trackers.hpp"

namespace truebearing::two_stage_bias_test {
namespace {

using testing::position;
using testing::RadarFilter;

Eigen::Matrix2d covariance(RandomStream& random, double position_m, double velocity_mps) {
  const Eigen::Matrix2d A = Eigen::Matrix2d::NullaryExpr([&] { return random.normal(); });
  const Eigen::Matrix2d scale = Eigen::Vector2d(position_m, velocity_mps).asDiagonal();
  return scale * (A * A.transpose() + 0.1 * Eigen::Matrix2d::Identity()) * scale;
}

TEST(CompanionDifference, IsTheTwoStageBiasEstimate) {
  for (std::uint64_t run = 0; run < 200; ++run) {
    RandomStream random({.seed = 31, .role = Role::evaluation, .run = run}, StreamId::test);
    RadarFilter radar;
    radar.sigma_m = std::pow(10.0, random.uniform(1.0, 4.0));
    radar.noise_variance = {std::pow(10.0, random.uniform(-1.0, 2.0)), std::pow(10.0, random.uniform(-2.0, 1.0))};
    const Eigen::Matrix2d P0 = covariance(random, 30.0, 30.0), M = covariance(random, 1000.0, 200.0);
    const auto started_at = [&](const Eigen::Matrix2d& P) {
      return testing::RadarTracker(line_space(), radar.motion(), radar.sensor(),
                                   PriorStart{Eigen::Vector2d::Zero(), P});
    };
    testing::RadarTracker base = started_at(P0), companion = started_at(P0 + M);

    Eigen::Matrix2d U = Eigen::Matrix2d::Identity();
    Eigen::Matrix2d information = M.llt().solve(Eigen::Matrix2d::Identity());
    Eigen::Vector2d information_vector = Eigen::Vector2d::Zero();
    const Eigen::RowVector2d H(1.0, 0.0);
    double time_s = 0.0;
    const double velocity = 200.0 * random.normal();
    for (int k = 0; k < 100; ++k) {
      const double dt_s = random.uniform(0.2, 3.0);
      time_s += dt_s;
      const Measurement measurement = position(time_s, velocity * time_s + radar.sigma_m * random.normal());
      const StepRecord record = base.step(measurement)[0];
      const StepRecord wide = companion.step(measurement)[0];

      U = radar.motion().F(dt_s) * U;
      const Eigen::RowVector2d s = H * U;
      const double S = record.innovation->S(0, 0);
      information += s.transpose() * s / S;
      information_vector += s.transpose() * record.innovation->nu[0] / S;
      U = (Eigen::Matrix2d::Identity() - Eigen::Vector2d(*record.gain) * H) * U;

      const Eigen::LLT<Eigen::Matrix2d> cholesky(information);
      const Eigen::Vector2d x = Eigen::Vector2d(record.x) + U * cholesky.solve(information_vector);
      const Eigen::Matrix2d P = Eigen::Matrix2d(record.P) + U * cholesky.solve(U.transpose());
      // Of the size that the numbers have on the way: the difference, and the two standard deviations.
      for (int i = 0; i < 2; ++i) {
        const double size = std::abs(wide.x[i]) + std::abs(wide.x[i] - record.x[i]) + std::sqrt(wide.P(i, i));
        ASSERT_NEAR(wide.x[i], x[i], 1e-10 * size) << run << " " << k;
        for (int j = 0; j < 2; ++j)
          ASSERT_NEAR(wide.P(i, j), P(i, j), 1e-10 * std::sqrt(wide.P(i, i) * wide.P(j, j))) << run << " " << k;
      }
    }
  }
}

}  // namespace
}  // namespace truebearing::two_stage_bias_test
