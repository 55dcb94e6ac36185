// SPDX-License-Identifier: Apache-2.0
#include "training/covariance_inflation.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "truebearing/core/error.hpp"

namespace truebearing::covariance_inflation_test {
namespace {

// Three narrow rules at -1, 0 and 1 of one input, apart so far that each row belongs to one of them.
FuzzyNetwork separate_rules() {
  return FuzzyNetwork({.input_mean = Eigen::VectorXd::Zero(1),
                       .input_scale = Eigen::VectorXd::Ones(1),
                       .input_clip = 4.0,
                       .centres = Eigen::Vector3d(-1.0, 0.0, 1.0),
                       .widths = Eigen::Vector3d::Constant(0.05),
                       .consequents = Eigen::Vector3d::Zero(),
                       .output_scale = Eigen::VectorXd::Ones(1)});
}

TEST(CovarianceInflation, IsTheMeanErrorWhereTheRuleHolds) {
  const Eigen::MatrixXd features = Eigen::Vector<double, 5>(-1.0, -1.0, 0.0, 1.0, 1.0);
  const Eigen::VectorXd errors = Eigen::Vector<double, 5>(1.0, 3.0, 5.0, 0.5, 0.0);
  const Eigen::VectorXd inflation = covariance_inflation(separate_rules(), features, errors);
  EXPECT_LT((inflation - Eigen::Vector3d(2.0, 5.0, 0.25)).norm(), 1e-12);
}

TEST(CovarianceInflation, UnusedRulesGetTheGlobalMean) {
  const Eigen::MatrixXd features = Eigen::Vector4d(-1.0, -1.0, -1.0, 1.0);
  const Eigen::VectorXd errors = Eigen::Vector4d(1.0, 2.0, 3.0, 6.0);
  const Eigen::VectorXd inflation = covariance_inflation(separate_rules(), features, errors, 0.3);
  EXPECT_LT((inflation - Eigen::Vector3d(2.0, 3.0, 3.0)).norm(), 1e-12);
}

TEST(CovarianceInflation, RefusesBadInput) {
  const FuzzyNetwork network = separate_rules();
  const Eigen::MatrixXd features = Eigen::Vector2d(0.0, 1.0);
  EXPECT_THROW(covariance_inflation(network, features, Eigen::Vector3d::Ones()), InputError);
  EXPECT_THROW(covariance_inflation(network, Eigen::MatrixXd::Zero(2, 2), Eigen::Vector2d::Ones()), InputError);
  EXPECT_THROW(covariance_inflation(network, Eigen::MatrixXd(0, 1), Eigen::VectorXd()), InputError);
  EXPECT_THROW(covariance_inflation(network, features, Eigen::Vector2d(1.0, -1.0)), InputError);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(covariance_inflation(network, features, Eigen::Vector2d(1.0, nan)), InputError);
}

}  // namespace
}  // namespace truebearing::covariance_inflation_test
