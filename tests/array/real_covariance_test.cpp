// SPDX-License-Identifier: Apache-2.0
#include "truebearing/array/real_covariance.hpp"

#include <gtest/gtest.h>

#include "tests/support/array_scene.hpp"
#include "truebearing/array/angle_likelihood.hpp"
#include "truebearing/array/sample_covariance.hpp"
#include "truebearing/core/simd_lanes.hpp"

namespace truebearing::real_covariance_test {
namespace {

using testing::ArrayScene;
using testing::scene_of;
using testing::Snapshots;

// The unitary transformation (M x M), by the header's formula: rows of sums, then of differences, then the middle.
Eigen::MatrixXcd transformation(int M) {
  Eigen::MatrixXcd Q = Eigen::MatrixXcd::Zero(M, M);
  const int pairs = M / 2;
  const std::complex<double> j(0.0, 1.0);
  for (int i = 0; i < pairs; ++i) {
    const int above = M - pairs + i, below = pairs - 1 - i;
    Q(i, above) = Q(i, below) = 1.0 / std::sqrt(2.0);
    Q(pairs + i, above) = 1.0 / (j * std::sqrt(2.0));
    Q(pairs + i, below) = -1.0 / (j * std::sqrt(2.0));
  }
  if (M % 2 == 1) Q(M - 1, pairs) = 1.0;
  return Q;
}

RealInterval real(const Interval& interval, int blocks = 1) {
  RealInterval taken;
  taken.take(interval, blocks);
  return taken;
}

Snapshots draw(const ArrayScene& scene, std::uint64_t run = 0) {
  RandomStream random({1, Role::evaluation, run}, StreamId::test);
  return scene.draw(random);
}

TEST(RealCovariance, IsTheRealPartOfTheTransformedCovariance) {
  for (const int sensors : {2, 5, 8, 15, 16, 18}) {
    ArrayScene scene = scene_of({-30.0, 7.0});
    scene.sensors = sensors;
    const Interval interval = scene.interval(draw(scene));
    Eigen::MatrixXcd R;
    sample_covariance(interval, R);
    const Eigen::MatrixXcd Q = transformation(sensors);
    ASSERT_LT((Q * Q.adjoint() - Eigen::MatrixXcd::Identity(sensors, sensors)).norm(), 1e-12);
    const Eigen::MatrixXd expected = (Q * R * Q.adjoint()).real();
    const RealInterval taken = real(interval);
    ASSERT_EQ(taken.count(), 1);
    const RealCovariance& block = taken.block(0);
    ASSERT_EQ(block.R.rows(), padded_to_lanes(sensors));
    EXPECT_LT((block.R.topLeftCorner(sensors, sensors) - expected).norm(), 1e-12 * expected.norm()) << sensors;
    EXPECT_NEAR(block.R.norm(), expected.norm(), 1e-12 * expected.norm()) << "the padding of " << sensors;
    EXPECT_NEAR(block.trace, R.trace().real(), 1e-12 * block.trace);
    EXPECT_EQ(block.snapshots, 30.0);
    EXPECT_EQ(taken.snapshots(), 30.0);
    EXPECT_EQ(taken.array().live_rows, sensors);
  }
}

TEST(RealCovariance, SteeringVectorsAreTheTransformedOnesWithPhasesFromTheMiddle) {
  for (const int sensors : {2, 5, 8, 15, 16}) {
    ArrayScene scene = scene_of({0.0});
    scene.sensors = sensors;
    scene.spacing_wavelengths = 0.45;
    const RealInterval taken = real(scene.interval(draw(scene)));
    for (const double angle_deg : {-70.0, -12.0, 0.0, 33.0}) {
      const double step = scene.array().phase_step(radians(angle_deg));
      const Eigen::VectorXcd expected = transformation(sensors) * testing::steering(scene.array(), radians(angle_deg)) *
                                        std::polar(1.0, -0.5 * (sensors - 1) * step);
      ASSERT_LT(expected.imag().norm(), 1e-12);
      const Eigen::Index rows = taken.array().padded;
      Eigen::VectorXd a = Eigen::VectorXd::Constant(rows, 7.0), d = a, before = a, after = a, unused = a;
      steer_real(taken.array(), radians(angle_deg), a.data(), d.data());
      EXPECT_LT((a.head(sensors) - expected.real()).norm(), 1e-12) << sensors;
      EXPECT_TRUE(a.tail(rows - sensors).isZero(0.0) && d.tail(rows - sensors).isZero(0.0));
      constexpr double kStep_rad = 1e-6;
      steer_real(taken.array(), radians(angle_deg) - kStep_rad, before.data(), unused.data());
      steer_real(taken.array(), radians(angle_deg) + kStep_rad, after.data(), unused.data());
      const Eigen::VectorXd differences = (after - before) / (2.0 * kStep_rad);
      EXPECT_LT((d - differences).norm(), 1e-6 * differences.norm()) << sensors;
    }
  }
}

TEST(RealCovariance, DeadSensorTakesTheOtherOfItsPairWithIt) {
  for (const int sensors : {15, 16})
    for (const int dead : {0, 3, 7, 14}) {
      ArrayScene scene = scene_of({-30.0, 7.0});
      scene.sensors = sensors;
      Snapshots values = draw(scene);
      for (int t = 0; t < 30; ++t) values[static_cast<std::size_t>(t * sensors + dead)] = 0.0;
      const RealInterval with_dead = real(scene.interval(values));
      const int other = sensors - 1 - dead;
      for (int t = 0; t < 30; ++t) values[static_cast<std::size_t>(t * sensors + other)] = std::nan("");
      const RealInterval with_both = real(scene.interval(values));
      EXPECT_EQ(with_dead.block(0).R, with_both.block(0).R) << dead;
      EXPECT_EQ(with_dead.array().live_rows, dead == other ? sensors - 1 : sensors - 2);
      EXPECT_EQ(with_dead.array().live_rows, with_both.array().live_rows);
      EXPECT_TRUE(with_dead.block(0).R.allFinite());
      // What is left is what it was.
      const RealInterval whole = real(scene.interval(draw(scene)));
      const Eigen::VectorXd live = with_dead.array().live;
      const Eigen::MatrixXd masked = live.asDiagonal() * whole.block(0).R * live.asDiagonal();
      EXPECT_LT((with_dead.block(0).R - masked).norm(), 1e-12 * masked.norm());
      Eigen::VectorXd a(with_dead.array().padded), d(with_dead.array().padded);
      steer_real(with_dead.array(), 0.2, a.data(), d.data());
      EXPECT_TRUE((a.array() * (1.0 - live.array())).isZero(0.0));
      EXPECT_NEAR(a.squaredNorm(), with_dead.array().live_rows, 1e-12 * sensors);
    }
}

TEST(RealCovariance, BlocksAreConsecutiveTimesWithCovariancesOfTheirOwn) {
  const ArrayScene scene = scene_of({-30.0, 7.0});
  Snapshots values = draw(scene);
  values[12 * 15] = {std::nan(""), 0.0};  // snapshot 12, of the second block
  const RealInterval three = real(scene.interval(values), 3);
  ASSERT_EQ(three.count(), 3);
  EXPECT_EQ(three.snapshots(), 29.0);
  const double sizes[] = {10.0, 9.0, 10.0};
  for (int b = 0; b < 3; ++b) {
    ArrayScene part = scene;
    part.snapshots = 10;
    const Snapshots of_block(values.begin() + b * 150, values.begin() + (b + 1) * 150);
    const RealInterval alone = real(part.interval(of_block));
    EXPECT_LT((three.block(b).R - alone.block(0).R).norm(), 1e-12 * alone.block(0).R.norm()) << b;
    EXPECT_EQ(three.block(b).snapshots, sizes[b]);
    double time_s = 0.0;
    for (int t = b * 10; t < (b + 1) * 10; ++t)
      if (t != 12) time_s -= (29.0 - t) / 30.0 / sizes[b];
    EXPECT_NEAR(three.block(b).time_s, time_s, 1e-12) << b;
  }
}

TEST(RealCovariance, BlockWithoutSnapshotsIsLeftOut) {
  const ArrayScene scene = scene_of({-30.0, 7.0});
  Snapshots values = draw(scene);
  for (std::size_t i = 150; i < 300; ++i) values[i] = {std::nan(""), 0.0};
  const RealInterval taken = real(scene.interval(values), 3);
  ASSERT_EQ(taken.count(), 2);
  EXPECT_EQ(taken.block(0).snapshots, 10.0);
  EXPECT_NEAR(taken.block(1).time_s, -4.5 / 30.0, 1e-12);
  EXPECT_EQ(real(scene.interval(draw(scene)), 100).count(), 30);  // more blocks than snapshots
}

TEST(RealCovariance, ForgetsWhatItHeldOfArraysOfOtherSizes) {
  RealInterval reused;
  for (const int sensors : {16, 15, 16, 13, 4, 3, 20, 18, 17}) {
    ArrayScene scene = scene_of({-30.0, 7.0});
    scene.sensors = sensors;
    const Interval interval = scene.interval(draw(scene));
    reused.take(interval, 3);
    const RealInterval fresh = real(interval, 3);
    for (int b = 0; b < 3; ++b) {
      EXPECT_EQ(reused.block(b).R, fresh.block(b).R) << sensors;
      EXPECT_EQ(reused.block(b).trace, fresh.block(b).trace) << sensors;
    }
  }
}

}  // namespace
}  // namespace truebearing::real_covariance_test
