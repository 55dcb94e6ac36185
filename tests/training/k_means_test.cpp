// SPDX-License-Identifier: Apache-2.0
#include "training/k_means.hpp"

#include <gtest/gtest.h>

#include "training/fuzzy_training.hpp"
#include "truebearing/core/error.hpp"

namespace truebearing::k_means_test {
namespace {

Eigen::MatrixXd normal_points(Eigen::Index count, std::uint64_t run) {
  RandomStream random(RunKey{.run = run}, StreamId::test);
  return Eigen::MatrixXd::NullaryExpr(count, 2, [&] { return random.normal(); });
}

TEST(KMeans, FindsClustersThatStandApart) {
  const Eigen::Matrix<double, 4, 2> middles{{0, 0}, {10, 0}, {0, 10}, {10, 10}};
  Eigen::MatrixXd points = 0.1 * normal_points(400, 1);
  for (Eigen::Index n = 0; n < points.rows(); ++n) points.row(n) += middles.row(n % 4);
  RandomStream random = learning_stream(1);
  const Eigen::MatrixXd centres = k_means(points, 4, random);
  for (Eigen::Index j = 0; j < 4; ++j) {
    EXPECT_LT((centres.rowwise() - middles.row(j)).rowwise().norm().minCoeff(), 0.1);  // 10 standard errors
  }
}

TEST(KMeans, SameSeedSameBitsOnASampleToo) {
  const Eigen::MatrixXd points = normal_points(1000, 2);
  for (const Eigen::Index max_points : {1000, 100}) {
    RandomStream first = learning_stream(7);
    RandomStream second = learning_stream(7);
    EXPECT_EQ(k_means(points, 8, first, {.max_points = max_points}),
              k_means(points, 8, second, {.max_points = max_points}));
  }
}

TEST(KMeans, EqualPointsAreNoTrouble) {
  RandomStream random = learning_stream(1);
  EXPECT_EQ(k_means(Eigen::MatrixXd::Ones(10, 2), 3, random), Eigen::MatrixXd::Ones(3, 2));
}

TEST(KMeans, RefusesMoreCentresThanPoints) {
  RandomStream random = learning_stream(1);
  EXPECT_THROW(k_means(Eigen::MatrixXd::Ones(3, 2), 4, random), InputError);
  EXPECT_THROW(k_means(Eigen::MatrixXd::Ones(3, 2), 0, random), InputError);
}

TEST(StratifiedRows, OnePerStratumAscending) {
  RandomStream random = learning_stream(1);
  const std::vector<Eigen::Index> rows = stratified_rows(1000, 100, random);
  ASSERT_EQ(rows.size(), 100U);
  for (std::size_t s = 0; s < rows.size(); ++s) EXPECT_EQ(rows[s] / 10, static_cast<Eigen::Index>(s));
  EXPECT_EQ(stratified_rows(3, 100, random), (std::vector<Eigen::Index>{0, 1, 2}));
}

}  // namespace
}  // namespace truebearing::k_means_test
