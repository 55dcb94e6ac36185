// SPDX-License-Identifier: Apache-2.0
#include "training/covariance_moments.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "truebearing/core/covariance.hpp"
#include "truebearing/core/error.hpp"
#include "truebearing/core/random.hpp"

namespace truebearing::covariance_moments_test {
namespace {

// Two narrow rules at -1 and 1 of one input, apart so far that each row belongs to one of them; two outputs.
FuzzyNetwork separate_rules() {
  return FuzzyNetwork({.input_mean = Eigen::VectorXd::Zero(1),
                       .input_scale = Eigen::VectorXd::Ones(1),
                       .input_clip = 4.0,
                       .centres = Eigen::Vector2d(-1.0, 1.0),
                       .widths = Eigen::Vector2d::Constant(0.05),
                       .consequents = Eigen::Matrix2d::Zero(),
                       .output_scale = Eigen::Vector2d::Ones()});
}

Eigen::Matrix2d matrix(const Eigen::MatrixXd& moments, Eigen::Index rule) {
  return moments.row(rule).reshaped(2, 2);
}

TEST(CovarianceMoments, AreTheMeanSquaresWhereTheRuleHolds) {
  const Eigen::MatrixXd features = Eigen::Vector3d(-1.0, -1.0, 1.0);
  const Eigen::MatrixXd errors = (Eigen::MatrixXd(3, 2) << 1.0, 2.0, 3.0, -2.0, 5.0, 1.0).finished();
  const Eigen::MatrixXd moments = covariance_moments(separate_rules(), features, errors);
  EXPECT_LT((matrix(moments, 0) - Eigen::Matrix2d{{5.0, -2.0}, {-2.0, 4.0}}).norm(), 1e-12);
  EXPECT_LT((matrix(moments, 1) - Eigen::Matrix2d{{25.0, 5.0}, {5.0, 1.0}}).norm(), 1e-12);
}

TEST(CovarianceMoments, OfMirrorPairsMirrorEachOther) {
  const Eigen::MatrixXd features = Eigen::Vector3d(-1.0, -1.0, 1.0);
  const Eigen::MatrixXd errors = (Eigen::MatrixXd(3, 2) << 1.0, 2.0, 3.0, -2.0, 5.0, 1.0).finished();
  const Eigen::MatrixXd moments = covariance_moments(separate_rules(), features, errors, {+1, -1});
  // Rule 2's row, mirrored, counts for rule 1: (5, -1).
  EXPECT_LT((matrix(moments, 0) - Eigen::Matrix2d{{35.0, -9.0}, {-9.0, 9.0}} / 3.0).norm(), 1e-12);
  EXPECT_LT((matrix(moments, 1) - Eigen::Matrix2d{{35.0, 9.0}, {9.0, 9.0}} / 3.0).norm(), 1e-12);
}

TEST(CovarianceMoments, EveryMixtureIsACovariance) {
  RandomStream random({.seed = 9}, StreamId::test);
  const Eigen::MatrixXd features = Eigen::MatrixXd::NullaryExpr(500, 1, [&] { return random.normal(); });
  const Eigen::MatrixXd errors = Eigen::MatrixXd::NullaryExpr(500, 2, [&] { return random.normal(); });
  const Eigen::MatrixXd moments = covariance_moments(separate_rules(), features, errors);
  for (int n = 0; n < 100; ++n) {
    const double share = random.uniform();
    EXPECT_TRUE(is_covariance(Eigen::Matrix2d(share * matrix(moments, 0) + (1.0 - share) * matrix(moments, 1))));
  }
}

TEST(CovarianceMoments, RefusesBadInput) {
  const FuzzyNetwork network = separate_rules();
  EXPECT_THROW(covariance_moments(network, Eigen::MatrixXd(0, 1), Eigen::MatrixXd(0, 2)), InputError);
  EXPECT_THROW(covariance_moments(network, Eigen::MatrixXd::Zero(2, 1), Eigen::MatrixXd::Zero(3, 2)), InputError);
  EXPECT_THROW(covariance_moments(network, Eigen::MatrixXd::Zero(2, 1), Eigen::MatrixXd::Zero(2, 3)), InputError);
  Eigen::MatrixXd errors = Eigen::MatrixXd::Zero(2, 2);
  errors(1, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(covariance_moments(network, Eigen::MatrixXd::Zero(2, 1), errors), InputError);
}

}  // namespace
}  // namespace truebearing::covariance_moments_test
