// SPDX-License-Identifier: Apache-2.0
#include "truebearing/tma/cho_pack.hpp"

#include <Eigen/LU>
#include <gtest/gtest.h>
#include <limits>

#include "tests/support/bearing_runs.hpp"
#include "truebearing/tma/cho_2015.hpp"

namespace truebearing::cho_pack_test {
namespace {

constexpr double kExact = 1e-12;

Eigen::Matrix4d normal_matrix(const ChoPack& pack, int k) {
  Eigen::Matrix4d A;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) A(i, j) = pack.sums[kNormalMatrix[i][j]][k];
  return A;
}
Eigen::Vector4d gradient(const ChoPack& pack, int k) {
  return {pack.sums[kRa][k], pack.sums[kRb][k], pack.sums[kRat][k], pack.sums[kRbt][k]};
}

class ChoPackTest : public ::testing::Test {
 protected:
  ChoPackTest() {
    for (int k = 0; k < kPack; ++k) set(k, cho_start(window_, 28 * k + 3));
    sum_pack(window_.arrays(), 0.0, pack_);
  }
  void set(int k, const Eigen::Vector4d& x) {
    for (int i = 0; i < 4; ++i) pack_.x[i][k] = x[i];
  }

  BearingWindow window_ = testing::two_legs({3000.0, 5000.0, -2.0, 1.0}, 300.0, 600.0, 1.0);
  ChoPack pack_{};
};

TEST_F(ChoPackTest, SumsAreThoseOfEachStartByItself) {
  for (int k = 0; k < kPack; ++k) {
    const NormalEquations<4> one = window_.cartesian(cho_start(window_, 28 * k + 3), 0.0);
    EXPECT_NEAR(pack_.sums[kCost][k] / one.cost, 1.0, kExact);
    EXPECT_LT((gradient(pack_, k) - one.gradient).cwiseAbs().maxCoeff(), kExact * one.gradient.cwiseAbs().maxCoeff());
    EXPECT_LT((normal_matrix(pack_, k) - one.A).cwiseAbs().maxCoeff(), kExact * one.A.maxCoeff());
  }
}

TEST_F(ChoPackTest, NoLaneDependsOnItsNeighbours) {
  ChoPack other{};
  for (int k = 0; k < kPack; ++k)  // one start in another lane, beside nonsense
    for (int i = 0; i < 4; ++i) other.x[i][k] = k == 6 ? pack_.x[i][1] : std::numeric_limits<double>::quiet_NaN();
  sum_pack(window_.arrays(), 0.0, other);
  pack_.mu[1] = other.mu[6] = 0.3;
  damped_steps(true, pack_);
  damped_steps(true, other);
  for (int row = 0; row < kCartesianRows; ++row) EXPECT_EQ(other.sums[row][6], pack_.sums[row][1]) << row;
  for (int i = 0; i < 4; ++i) EXPECT_EQ(other.h[i][6], pack_.h[i][1]);
  EXPECT_EQ(other.promised[6], pack_.promised[1]);
}

TEST_F(ChoPackTest, DampedStepsSolveEquationTen) {
  for (const bool marquardt : {false, true}) {
    for (int k = 0; k < kPack; ++k)
      pack_.mu[k] = 0.01 * (k + 1) * (marquardt ? 1.0 : normal_matrix(pack_, k).maxCoeff());
    damped_steps(marquardt, pack_);
    for (int k = 0; k < kPack; ++k) {
      const Eigen::Matrix4d A = normal_matrix(pack_, k);
      const Eigen::Vector4d D = marquardt ? Eigen::Vector4d(A.diagonal()) : Eigen::Vector4d::Ones(),
                            g = gradient(pack_, k);
      const Eigen::Vector4d h(pack_.h[0][k], pack_.h[1][k], pack_.h[2][k], pack_.h[3][k]);
      const Eigen::Matrix4d damped = A + Eigen::Matrix4d((pack_.mu[k] * D).asDiagonal());
      EXPECT_LT((damped * h - g).cwiseAbs().maxCoeff(), kExact * g.cwiseAbs().maxCoeff()) << marquardt << " " << k;
      EXPECT_NEAR(pack_.promised[k] / (0.5 * h.dot(pack_.mu[k] * D.cwiseProduct(h) + g)), 1.0, kExact);
    }
  }
}

TEST_F(ChoPackTest, WhatSaysNothingTakesNoStep) {
  for (auto& row : pack_.sums) row[2] = 0.0;
  pack_.mu[2] = 1.0;
  damped_steps(true, pack_);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(pack_.h[i][2], 0.0);
}

}  // namespace
}  // namespace truebearing::cho_pack_test
