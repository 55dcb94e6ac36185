// SPDX-License-Identifier: Apache-2.0
#include "truebearing/correction/plane_covariance_kernel.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>

#include "truebearing/core/constants.hpp"
#include "truebearing/core/covariance.hpp"
#include "truebearing/core/random.hpp"
#include "truebearing/correction/correction_inputs.hpp"

namespace truebearing::plane_covariance_kernel_test {
namespace {

class PlaneCovarianceKernel : public ::testing::Test {
 protected:
  Eigen::Matrix4d covariance() {
    Eigen::Matrix4d A;
    for (double& number : A.reshaped()) number = random_.normal();
    Eigen::Matrix4d P = A * A.transpose() + 0.1 * Eigen::Matrix4d::Identity();
    P.triangularView<Eigen::StrictlyUpper>() = P.transpose();
    return P;
  }
  Eigen::Vector4d vector() {
    return Eigen::Vector4d::NullaryExpr([&] { return random_.normal(); });
  }

  RandomStream random_{{}, StreamId::test};
};

TEST_F(PlaneCovarianceKernel, OwnCovarianceIsThatOfAnySizeToTheBit) {
  for (int run = 0; run < 200; ++run) {
    const Eigen::Matrix4d P = covariance();
    NetworkAnswer answer;
    answer.moments = covariance();
    StepRecord base;
    base.x = vector();
    for (const Frame frame : {Frame::state, Frame::track}) {
      const FrameRotation rotation(frame, base.x);
      BoundedMatrix any_size = P;
      OutputUnits(rotation, base, false).own_covariance(answer, any_size);
      Eigen::Matrix4d own;
      kernels::plane_own_covariance(P.data(), answer.moments.data(), rotation.axis(), own.data());
      for (int j = 0; j < 4; ++j)
        for (int i = j; i < 4; ++i) EXPECT_EQ(own(i, j), any_size(i, j)) << to_string(frame) << ' ' << i << ' ' << j;
    }
  }
}

TEST_F(PlaneCovarianceKernel, SquaredDistanceIsThatOfAnySizeToTheBit) {
  for (int run = 0; run < 200; ++run) {
    const Eigen::Matrix4d P_a = covariance(), P_b = covariance();
    const Eigen::Vector4d d = vector();
    double squared = 0.0;
    kernels::plane_squared_distance(P_a.data(), P_b.data(), d.data(), squared);
    EXPECT_EQ(squared, mahalanobis_squared(P_a + P_b, d));
  }
}

TEST_F(PlaneCovarianceKernel, SquaredDistanceIsNoNumberWhereTheSumIsNotPositiveDefinite) {
  const Eigen::Matrix4d P_a = covariance(), P_b = -2.0 * P_a;
  const Eigen::Vector4d d = vector();
  double squared = 0.0;
  kernels::plane_squared_distance(P_a.data(), P_b.data(), d.data(), squared);
  EXPECT_TRUE(std::isnan(squared));
}

TEST_F(PlaneCovarianceKernel, BlendsNumberByNumber) {
  for (int run = 0; run < 200; ++run) {
    const Eigen::Matrix4d P_a = covariance(), P_b = covariance();
    const Eigen::Vector4d d = vector();
    const double g = random_.uniform(0.0, 1.0), h = random_.uniform(0.0, 1.0);
    const double a[] = {g, std::sqrt(g * h), std::sqrt(g * h), h};
    const double b[] = {1.0 - g, std::sqrt((1.0 - g) * (1.0 - h)), std::sqrt((1.0 - g) * (1.0 - h)), 1.0 - h};
    Eigen::Matrix4d P;
    bool definite = false;
    kernels::plane_blend(P_a.data(), P_b.data(), d.data(), a, b, 1e-9, 1e100, P.data(), definite);
    EXPECT_TRUE(definite);
    for (int j = 0; j < 4; ++j)
      for (int i = j; i < 4; ++i) {
        const double A = a[i / 2 * 2 + j / 2], B = b[i / 2 * 2 + j / 2];
        EXPECT_EQ(P(i, j), P_b(i, j) + A * (P_a(i, j) - P_b(i, j)) - (1.0 - A - B) * P_b(i, j) + A * B * d[i] * d[j]);
        EXPECT_EQ(P(i, j), P(j, i));
      }
  }
}

TEST_F(PlaneCovarianceKernel, SaysWhereABlendIsFarFromNoCovariance) {
  const double a[] = {1.0, 1.0, 1.0, 1.0}, b[] = {0.0, 0.0, 0.0, 0.0};  // P_a itself
  const Eigen::Vector4d d = Eigen::Vector4d::Zero();
  const auto definite = [&](const Eigen::Matrix4d& P_a) {
    Eigen::Matrix4d P;
    bool said = false;
    kernels::plane_blend(P_a.data(), P_a.data(), d.data(), a, b, 1e-9, 1e100, P.data(), said);
    return said;
  };
  EXPECT_TRUE(definite(covariance()));
  Eigen::Matrix4d close = Eigen::Matrix4d::Identity();
  close(3, 2) = close(2, 3) = 1.0 - 1e-10;
  EXPECT_FALSE(definite(close));
  EXPECT_FALSE(definite(1e101 * Eigen::Matrix4d::Identity()));
  EXPECT_FALSE(definite(kNaN * Eigen::Matrix4d::Identity()));
}

}  // namespace
}  // namespace truebearing::plane_covariance_kernel_test
