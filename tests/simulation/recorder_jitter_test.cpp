// SPDX-License-Identifier: Apache-2.0
#include "truebearing/simulation/recorder_jitter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/support/statistics.hpp"

namespace truebearing::recorder_jitter_test {
namespace {

using testing::mean_margin;
using testing::moments;

RandomStream stream() {
  return {{1, Role::evaluation, 0}, StreamId::process};
}

/// Straight on at (30, 40) m/s, sampled every second.
Eigen::Matrix4Xd straight_track(Eigen::Index samples) {
  Eigen::Matrix4Xd track(4, samples);
  for (Eigen::Index k = 0; k < samples; ++k)
    track.col(k) << 30.0 * static_cast<double>(k), 40.0 * static_cast<double>(k), 30.0, 40.0;
  return track;
}

TEST(RecorderJitter, NoneLeavesTheTrack) {
  RandomStream numbers = stream();
  const Eigen::Matrix4Xd track = straight_track(100);
  EXPECT_EQ(RecorderJitter{}.record(track, numbers), track.topRows<2>());
}

TEST(RecorderJitter, TimeErrorIsLaplaceAlongTheVelocity) {
  RecorderJitter jitter;
  jitter.time_sigma_s = 0.5;
  const Eigen::Matrix4Xd track = straight_track(100'000);
  RandomStream numbers = stream();
  const Eigen::Matrix2Xd moved = jitter.record(track, numbers) - track.topRows<2>();
  std::vector<double> error_s, absolute_s, squared_s2;
  for (Eigen::Index k = 0; k < moved.cols(); ++k) {
    EXPECT_NEAR(moved(0, k) * 40.0 - moved(1, k) * 30.0, 0.0, 1e-6);
    error_s.push_back(moved(0, k) / 30.0);
    absolute_s.push_back(std::abs(error_s.back()));
    squared_s2.push_back(error_s.back() * error_s.back());
  }
  EXPECT_LT(std::abs(moments(error_s).mean), mean_margin(0.5, error_s.size()));
  // Of a Laplace law of deviation s: E|e| = s/sqrt(2) with variance s^2/2, E e^2 = s^2 with variance 5 s^4.
  EXPECT_NEAR(moments(absolute_s).mean, 0.5 / std::sqrt(2.0), mean_margin(0.5 / std::sqrt(2.0), error_s.size()));
  EXPECT_NEAR(moments(squared_s2).mean, 0.25, mean_margin(std::sqrt(5.0) * 0.25, error_s.size()));
}

TEST(RecorderJitter, KnotsComeAsOftenAsTheyShould) {
  RecorderJitter jitter;
  jitter.knots = {0.5, 0.3, 0.2};
  jitter.time_sigma_s = 0.5;
  EXPECT_EQ(jitter.margin(), 3);
  const Eigen::Matrix4Xd track = straight_track(100'000);
  RandomStream numbers = stream();
  const Eigen::Matrix2Xd recorded = jitter.record(track, numbers);
  // Between knots the second difference vanishes; at knots it does not.
  std::vector<double> spacings;
  Eigen::Index knot = 0;
  for (Eigen::Index k = 1; k + 1 < recorded.cols(); ++k) {
    const Eigen::Vector2d bend = recorded.col(k + 1) - 2.0 * recorded.col(k) + recorded.col(k - 1);
    if (bend.norm() < 1e-6) continue;
    spacings.push_back(static_cast<double>(k - knot));
    knot = k;
  }
  for (std::size_t n = 1; n <= 3; ++n) {
    std::vector<double> is_n;
    for (const double spacing : spacings) is_n.push_back(spacing == static_cast<double>(n));
    const double p = jitter.knots[n - 1];
    EXPECT_NEAR(moments(is_n).mean, p, mean_margin(std::sqrt(p * (1.0 - p)), is_n.size())) << n;
  }
}

}  // namespace
}  // namespace truebearing::recorder_jitter_test
