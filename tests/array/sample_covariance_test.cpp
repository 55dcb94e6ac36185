// SPDX-License-Identifier: Apache-2.0
#include "truebearing/array/sample_covariance.hpp"

#include <gtest/gtest.h>

#include "tests/support/array_scene.hpp"

namespace truebearing::sample_covariance_test {
namespace {

using testing::ArrayScene;
using testing::scene_of;

constexpr OrderCriterion kCriteria[] = {OrderCriterion::minimum_description_length, OrderCriterion::akaike};

ArrayScene many_snapshots(int targets) {
  static const std::vector<double> kAngles_deg{-48.0, -20.0, 3.0, 21.0, 45.0};
  ArrayScene scene = scene_of({kAngles_deg.begin(), kAngles_deg.begin() + targets});
  scene.snapshots = 500;
  return scene;
}

int count(const ArrayScene& scene, std::uint64_t run, OrderCriterion criterion) {
  RandomStream random({1, Role::evaluation, run}, StreamId::test);
  Eigen::MatrixXcd R;
  sample_covariance(scene.draw_interval(random), R);
  return source_count(signal_subspace(R, 0).eigenvalues, scene.snapshots, criterion);
}

TEST(SampleCovariance, IsTheMeanOfOuterProductsOfWhatIsUsable) {
  const ArrayScene scene = scene_of({-30.0, 2.0});
  RandomStream random({1, Role::evaluation, 0}, StreamId::test);
  testing::Snapshots values = scene.draw(random);
  values[4 * 15 + 2] = {std::nan(""), 0.0};
  for (std::size_t t = 0; t < 30; ++t) values[t * 15 + 9] = 0.0;
  Eigen::MatrixXcd R = Eigen::MatrixXcd::Constant(2, 2, 7.0), expected = Eigen::MatrixXcd::Zero(15, 15);
  sample_covariance(scene.interval(values), R);
  for (std::size_t t = 0; t < 30; ++t) {
    const Eigen::VectorXcd x = Eigen::Map<const Eigen::VectorXcd>(values.data() + t * 15, 15);
    if (t != 4) expected += x * x.adjoint() / 29.0;
  }
  EXPECT_LT((R - expected).norm(), 1e-12 * expected.norm());
  EXPECT_TRUE(R.row(9).isZero(0.0) && R.col(9).isZero(0.0));
  sample_covariance(scene.interval({}), R);
  EXPECT_TRUE(R.isZero(0.0));
}

TEST(SampleCovariance, SignalSubspaceIsThatOfTheLargestEigenvalues) {
  const ArrayScene scene = scene_of({-30.0, 2.0, 40.0});
  const Eigen::MatrixXcd R = scene.covariance();
  const SignalSubspace subspace = signal_subspace(R, 3);
  ASSERT_EQ(subspace.basis.cols(), 3);
  ASSERT_EQ(subspace.eigenvalues.size(), 15);
  for (Eigen::Index n = 0; n < 3; ++n) {  // the largest first, the values ascending
    const double value = subspace.eigenvalues[14 - n];
    EXPECT_LT((R * subspace.basis.col(n) - value * subspace.basis.col(n)).norm(), 1e-10 * value);
  }
  EXPECT_NEAR(subspace.eigenvalues.head(12).maxCoeff(), 1.0, 1e-10);
  EXPECT_TRUE(std::is_sorted(subspace.eigenvalues.begin(), subspace.eigenvalues.end()));
  EXPECT_LT((subspace.basis.adjoint() * subspace.basis - Eigen::MatrixXcd::Identity(3, 3)).norm(), 1e-12);
  for (const double angle : scene.angles_rad) {
    const Eigen::VectorXcd a = testing::steering(scene.array(), angle);
    EXPECT_NEAR((subspace.basis.adjoint() * a).squaredNorm(), 15.0, 1e-10);
  }
  EXPECT_EQ(signal_subspace(R, 0).basis.cols(), 0);
}

TEST(SourceCount, FindsNoneToFiveTargetsFromManySnapshots) {
  for (int targets = 0; targets <= 5; ++targets) {
    int akaike_exact = 0;
    for (std::uint64_t run = 0; run < 20; ++run) {
      EXPECT_EQ(count(many_snapshots(targets), run, OrderCriterion::minimum_description_length), targets) << run;
      const int akaike = count(many_snapshots(targets), run, OrderCriterion::akaike);
      EXPECT_GE(akaike, targets) << run;  // it is known to count too many, now and then
      akaike_exact += akaike == targets;
    }
    EXPECT_GE(akaike_exact, 10) << targets;
  }
}

// Twice the log likelihood of 15 eigenvalues that are one and the same grows with the snapshots, and so does Akaike's
// courage beside that of the description length.
TEST(SourceCount, AkaikeCountsNoLessThanTheDescriptionLength) {
  ArrayScene scene = scene_of({-30.0, 2.0, 7.0, 40.0}, 0.3);
  int sums[2] = {0, 0};
  for (std::uint64_t run = 0; run < 40; ++run) {
    const int lengths = count(scene, run, kCriteria[0]), akaike = count(scene, run, kCriteria[1]);
    EXPECT_LE(lengths, akaike) << run;
    sums[0] += lengths;
    sums[1] += akaike;
  }
  EXPECT_LT(sums[0], sums[1]);
}

TEST(SourceCount, BearsEigenvaluesThatAreZero) {
  Eigen::VectorXd eigenvalues = Eigen::VectorXd::Zero(6);
  for (const OrderCriterion criterion : kCriteria) {
    EXPECT_EQ(source_count(eigenvalues, 10, criterion), 0);
    Eigen::VectorXd one = eigenvalues;
    one[5] = 10.0;
    const int found = source_count(one, 10, criterion);
    EXPECT_GE(found, 1);
    EXPECT_LE(found, 5);
  }
}

}  // namespace
}  // namespace truebearing::sample_covariance_test
