// SPDX-License-Identifier: Apache-2.0
#include "truebearing/correction/fuzzy_partition.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "truebearing/core/error.hpp"
#include "truebearing/core/random.hpp"

namespace truebearing::fuzzy_partition_test {
namespace {

constexpr double kExact = 1e-12;

TEST(FuzzyPartition, NeighbouringTermsCrossAtOneHalf) {
  const FuzzyPartition partition = uniform_partition(Eigen::Vector2d(-1.0, 0.0), Eigen::Vector2d(1.0, 10.0), 3);
  ASSERT_EQ(partition.inputs(), 2);
  const double half_way = 2.5;
  const double membership = std::exp(-0.5 * std::pow((half_way - partition.centres[1][0]) / partition.widths[1][0], 2));
  EXPECT_NEAR(membership, 0.5, kExact);
  EXPECT_NEAR(partition.centres[1][1], 5.0, kExact);
}

// Chao and Teng's normalisation layer against the network's softmax over the rules.
TEST(FuzzyPartition, NormalisingTermsEqualsNormalisingProducts) {
  RandomStream random(RunKey{.run = 1}, StreamId::test);
  FuzzyPartition partition;
  for (const int terms : {3, 2, 4}) {
    partition.centres.emplace_back(Eigen::VectorXd::NullaryExpr(terms, [&] { return random.normal(); }));
    partition.widths.emplace_back(Eigen::VectorXd::NullaryExpr(terms, [&] { return random.uniform(0.3, 2.0); }));
  }
  const FuzzyNetwork network(expand(partition, 1));
  ASSERT_EQ(network.rules(), 24);
  FuzzyNetwork::Strengths phi;
  for (int n = 0; n < 100; ++n) {
    const FuzzyNetwork::Inputs u = FuzzyNetwork::Inputs::NullaryExpr(3, [&] { return random.uniform(-3.0, 3.0); });
    std::vector<Eigen::ArrayXd> memberships;
    for (std::size_t i = 0; i < 3; ++i) {
      const Eigen::ArrayXd distance =
          (u[static_cast<int>(i)] - partition.centres[i].array()) / partition.widths[i].array();
      const Eigen::ArrayXd membership = (-0.5 * distance.square()).exp();
      memberships.emplace_back(membership / membership.sum());
    }
    network.strengths(u, phi);
    for (int j = 0; j < network.rules(); ++j) {
      EXPECT_NEAR(phi[j], memberships[0][j / 8] * memberships[1][j / 4 % 2] * memberships[2][j % 4], kExact);
    }
  }
}

TEST(FuzzyPartition, RefusesBadPartitions) {
  const Eigen::Vector2d zero = Eigen::Vector2d::Zero();
  EXPECT_THROW(uniform_partition(zero, zero, 3), InputError);
  EXPECT_THROW(uniform_partition(zero, Eigen::Vector2d::Ones(), 1), InputError);
  EXPECT_THROW(uniform_partition(zero, Eigen::Vector3d::Ones(), 3), InputError);
  const Eigen::VectorXd six = Eigen::VectorXd::Ones(6);
  EXPECT_THROW(expand(uniform_partition(-six, six, 3), 1), InputError);  // 729 rules
  FuzzyPartition ragged = uniform_partition(zero, Eigen::Vector2d::Ones(), 3);
  ragged.widths[1].resize(2);
  EXPECT_THROW(expand(ragged, 1), InputError);
  ragged.widths.pop_back();
  EXPECT_THROW(expand(ragged, 1), InputError);
}

}  // namespace
}  // namespace truebearing::fuzzy_partition_test
