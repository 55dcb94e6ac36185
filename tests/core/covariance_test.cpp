// SPDX-License-Identifier: Apache-2.0
#include "truebearing/core/covariance.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>

#include "truebearing/core/constants.hpp"
#include "truebearing/core/random.hpp"

namespace truebearing::covariance_test {
namespace {

Eigen::MatrixXd random_matrix(int rows, int columns, RandomStream& stream) {
  Eigen::MatrixXd A(rows, columns);
  for (double& value : A.reshaped()) value = stream.normal();
  return A;
}

TEST(Covariance, GramMatricesOfEveryRankAreCovariances) {
  RandomStream stream({1, Role::evaluation, 0}, StreamId::test);
  for (int n = 1; n <= 4; ++n)
    for (int rank = 0; rank <= n; ++rank)
      for (int trial = 0; trial < 50; ++trial) {
        const Eigen::MatrixXd A = random_matrix(n, rank, stream);
        const Eigen::MatrixXd P = A * A.transpose();
        EXPECT_TRUE(is_covariance(P)) << "rank " << rank << "\n" << P;
      }
}

TEST(Covariance, OneNegativeEigenvalueIsFound) {
  RandomStream stream({2, Role::evaluation, 0}, StreamId::test);
  for (int n = 2; n <= 4; ++n)
    for (int trial = 0; trial < 200; ++trial) {
      const Eigen::MatrixXd A = random_matrix(n, n, stream);
      const Eigen::VectorXd direction = random_matrix(n, 1, stream).normalized();
      const Eigen::MatrixXd P = A * A.transpose() + 0.1 * Eigen::MatrixXd::Identity(n, n);
      // Taking more along a direction than P has there leaves x' P x < 0 for some x.
      const double most = 1.0 / direction.dot(P.ldlt().solve(direction));
      const Eigen::MatrixXd less = P - 0.999 * most * direction * direction.transpose();
      const Eigen::MatrixXd more = P - 1.001 * most * direction * direction.transpose();
      EXPECT_TRUE(is_covariance(less)) << less;
      EXPECT_FALSE(is_covariance(more)) << more;
    }
}

TEST(Covariance, ScaleOfTheComponentsDoesNotMatter) {
  Eigen::Matrix3d P;
  P << 4.0, 1.9, 0.0, 1.9, 1.0, 0.2, 0.0, 0.2, 9.0;
  Eigen::Matrix3d bad = P;
  bad(0, 1) = bad(1, 0) = 2.1;
  for (const double scale : {1e-12, 1.0, 1e12}) {
    const Eigen::Vector3d units(scale, 1.0, 1.0 / scale);
    EXPECT_TRUE(is_covariance(Eigen::Matrix3d(units.asDiagonal() * P * units.asDiagonal()))) << scale;
    EXPECT_FALSE(is_covariance(Eigen::Matrix3d(units.asDiagonal() * bad * units.asDiagonal()))) << scale;
  }
}

TEST(Covariance, ZeroVarianceAllowsNoCorrelation) {
  Eigen::Matrix3d P = Eigen::Vector3d(1.0, 0.0, 2.0).asDiagonal();
  EXPECT_TRUE(is_covariance(P));
  P(0, 1) = P(1, 0) = 0.1;
  EXPECT_FALSE(is_covariance(P));
}

TEST(Covariance, WhatIsNoCovarianceIsRefused) {
  const Eigen::Matrix2d P = Eigen::Matrix2d::Identity();
  for (const double value : {-1.0, kNaN, kInfinity, -kInfinity}) {
    Eigen::Matrix2d diagonal = P;
    diagonal(1, 1) = value;
    EXPECT_FALSE(is_covariance(diagonal)) << value;
  }
  for (const double value : {kNaN, kInfinity}) {
    Eigen::Matrix2d off = P;
    off(0, 1) = off(1, 0) = value;
    EXPECT_FALSE(is_covariance(off)) << value;
  }
  Eigen::Matrix2d asymmetric = P;
  asymmetric(0, 1) = 0.1;
  EXPECT_FALSE(is_covariance(asymmetric));
  EXPECT_FALSE(is_covariance(Eigen::MatrixXd::Identity(2, 3)));
}

TEST(Covariance, MahalanobisIsTheDistanceInSigmas) {
  Eigen::Matrix2d P;
  P << 4.0, 1.0, 1.0, 9.0;
  const Eigen::Vector2d d(2.0, -3.0);
  EXPECT_NEAR(mahalanobis_squared(P, d), d.dot(P.inverse() * d), 1e-12);
  EXPECT_TRUE(std::isnan(mahalanobis_squared(Eigen::Matrix2d(-P), d)));
}

TEST(Covariance, LogDensityIsTheNormalDensity) {
  const Eigen::Matrix<double, 1, 1> S(4.0), nu(3.0);
  EXPECT_NEAR(log_density(S, nu), std::log(std::exp(-9.0 / 8.0) / std::sqrt(2.0 * std::numbers::pi * 4.0)), 1e-12);
  Eigen::Matrix2d S2;
  S2 << 2.0, 0.5, 0.5, 1.0;
  const Eigen::Vector2d nu2(0.3, -1.0);
  const double expected =
      -0.5 * nu2.dot(S2.inverse() * nu2) - std::log(2.0 * std::numbers::pi) - 0.5 * std::log(S2.determinant());
  EXPECT_NEAR(log_density(S2, nu2), expected, 1e-12);
  EXPECT_TRUE(std::isnan(log_density(Eigen::Matrix2d(Eigen::Matrix2d::Zero()), nu2)));
}

}  // namespace
}  // namespace truebearing::covariance_test
