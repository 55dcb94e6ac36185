// SPDX-License-Identifier: Apache-2.0
#include "truebearing/array/orthogonal_iteration.hpp"

#include <gtest/gtest.h>

#include <Eigen/QR>

#include "tests/support/array_scene.hpp"
#include "truebearing/array/sample_covariance.hpp"

namespace truebearing::orthogonal_iteration_test {
namespace {

using testing::joined;
using testing::scene_of;

Eigen::MatrixXcd projector(const Eigen::MatrixXcd& W) {
  return W * (W.adjoint() * W).ldlt().solve(W.adjoint());
}

Eigen::MatrixXcd some_basis(RandomStream& random, Eigen::Index rows, Eigen::Index columns) {
  Eigen::MatrixXcd basis(rows, columns);
  for (std::complex<double>& value : basis.reshaped()) value = testing::complex_normal(random);
  return basis;
}

double away_from_orthonormal(const Eigen::MatrixXcd& W) {
  return (W.adjoint() * W - Eigen::MatrixXcd::Identity(W.cols(), W.cols())).norm();
}

TEST(OrthogonalIteration, SpansTheSampleCovarianceTimesTheBasis) {
  const testing::ArrayScene scene = scene_of({-30.0, 2.0, 40.0});
  RandomStream random({1, Role::evaluation, 0}, StreamId::test);
  const Eigen::MatrixXcd basis = some_basis(random, 15, 3);
  const Interval interval = scene.draw_interval(random);
  OrthogonalIteration iteration;
  iteration.begin(basis);
  iteration.update(interval);
  const Eigen::MatrixXcd W = joined(iteration.basis(), 15);
  Eigen::MatrixXcd R;
  sample_covariance(interval, R);
  EXPECT_LT(away_from_orthonormal(W), 1e-12);
  EXPECT_LT((projector(W) - projector(R * basis)).norm(), 1e-10);
}

TEST(OrthogonalIteration, OfTheSameIntervalAgainAndAgainConvergesToItsEigenvectors) {
  const testing::ArrayScene scene = scene_of({-30.0, 2.0, 40.0});
  RandomStream random({2, Role::evaluation, 0}, StreamId::test);
  const Interval interval = scene.draw_interval(random);
  OrthogonalIteration iteration;
  iteration.begin(some_basis(random, 15, 3));
  for (int i = 0; i < 30; ++i) iteration.update(interval);
  Eigen::MatrixXcd R;
  sample_covariance(interval, R);
  EXPECT_LT((projector(joined(iteration.basis(), 15)) - projector(signal_subspace(R, 3).basis)).norm(), 1e-8);
}

TEST(OrthogonalIteration, KeepsFiniteColumnsWhereAnIntervalHoldsTooLittle) {
  testing::ArrayScene scene = scene_of({-30.0, 2.0, 40.0});
  scene.snapshots = 1;  // of rank 1, and three columns
  RandomStream random({3, Role::evaluation, 0}, StreamId::test);
  OrthogonalIteration iteration;
  iteration.begin(some_basis(random, 15, 3));
  iteration.update(scene.draw_interval(random));
  EXPECT_TRUE(joined(iteration.basis(), 15).allFinite());
  iteration.update(scene.interval(testing::Snapshots(15, 0.0)));
  EXPECT_TRUE(joined(iteration.basis(), 15).allFinite());
  scene.snapshots = 30;
  for (int i = 0; i < 3; ++i) iteration.update(scene.draw_interval(random));
  EXPECT_LT(away_from_orthonormal(joined(iteration.basis(), 15)), 1e-9);
}

}  // namespace
}  // namespace truebearing::orthogonal_iteration_test
