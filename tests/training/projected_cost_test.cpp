// SPDX-License-Identifier: Apache-2.0
#include "training/projected_cost.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "truebearing/core/random.hpp"
#include "truebearing/correction/fuzzy_network.hpp"

namespace truebearing::projected_cost_test {
namespace {

constexpr double kExact = 1e-12;
constexpr double kDerivative = 1e-6;

struct Problem {
  Eigen::MatrixXd U, T, centres, widths;
};

Problem random_problem(Eigen::Index rows, Eigen::Index rules) {
  RandomStream random(RunKey{.run = 1}, StreamId::test);
  const auto normal = [&] { return random.normal(); };
  return {Eigen::MatrixXd::NullaryExpr(rows, 3, normal), Eigen::MatrixXd::NullaryExpr(rows, 2, normal),
          Eigen::MatrixXd::NullaryExpr(rules, 3, normal),
          Eigen::MatrixXd::NullaryExpr(rules, 3, [&] { return random.uniform(0.4, 1.5); })};
}

TEST(ProjectedCost, StrengthsAreThoseOfTheNetwork) {
  const Problem problem = random_problem(100, 5);
  Eigen::MatrixXd phi(100, 5);
  block_strengths(exponent_basis(problem.U), exponent_coefficients(problem.centres, problem.widths), phi);
  const FuzzyNetwork network({.input_mean = Eigen::VectorXd::Zero(3),
                              .input_scale = Eigen::VectorXd::Ones(3),
                              .input_clip = 100.0,
                              .centres = problem.centres,
                              .widths = problem.widths,
                              .consequents = Eigen::MatrixXd::Zero(5, 2),
                              .output_scale = Eigen::VectorXd::Ones(2)});
  FuzzyNetwork::Strengths expected;
  for (Eigen::Index n = 0; n < 100; ++n) {
    network.strengths(problem.U.row(n).transpose(), expected);
    EXPECT_LT((phi.row(n).transpose() - expected).norm(), kExact);
  }
}

// Several blocks, the last one short, and outputs of different weight.
TEST(ProjectedCost, GradientIsThatOfFiniteDifferences) {
  Problem problem = random_problem(2 * kBlockRows + 57, 6);
  const double lambda = 0.01;
  ProjectedCost projected_cost(Eigen::Vector2d(1.0, 3.0), lambda);
  ProjectedCost::Gradient gradient, unused;
  projected_cost.evaluate(problem.U, problem.T, problem.centres, problem.widths, gradient);
  const double scale = std::max(gradient.centres.cwiseAbs().maxCoeff(), gradient.log_widths.cwiseAbs().maxCoeff());
  const double step = 1e-5;
  const auto difference = [&](double& parameter, double up, double down) {
    const double kept = parameter;
    parameter = up;
    const double above = projected_cost.evaluate(problem.U, problem.T, problem.centres, problem.widths, unused);
    parameter = down;
    const double below = projected_cost.evaluate(problem.U, problem.T, problem.centres, problem.widths, unused);
    parameter = kept;
    return (above - below) / (2.0 * step);
  };
  for (Eigen::Index k = 0; k < problem.centres.size(); ++k) {
    double& c = problem.centres.data()[k];
    EXPECT_NEAR(gradient.centres.data()[k], difference(c, c + step, c - step), kDerivative * scale);
    double& s = problem.widths.data()[k];
    EXPECT_NEAR(gradient.log_widths.data()[k], difference(s, s * std::exp(step), s * std::exp(-step)),
                kDerivative * scale);
  }
}

TEST(ConsequentEquations, ConsequentsMinimiseTheCostTheyReport) {
  const Problem problem = random_problem(200, 5);
  Eigen::MatrixXd phi(200, 5);
  block_strengths(exponent_basis(problem.U), exponent_coefficients(problem.centres, problem.widths), phi);
  ConsequentEquations equations(5, 2);
  equations.add(phi.topRows(120), problem.T.topRows(120));
  equations.add(phi.bottomRows(80), problem.T.bottomRows(80));
  const double lambda = 0.1;
  const Eigen::MatrixXd W = equations.consequents(lambda);
  const Eigen::VectorXd cost = equations.cost(W, lambda);
  const Eigen::RowVectorXd expected =
      (problem.T - phi * W).colwise().squaredNorm() / 200.0 + lambda / 5.0 * W.colwise().squaredNorm();
  EXPECT_LT((cost - expected.transpose()).norm(), kExact);
  for (Eigen::Index k = 0; k < W.size(); ++k) {
    for (const double change : {-0.01, 0.01}) {
      Eigen::MatrixXd other = W;
      other.data()[k] += change;
      EXPECT_GT(equations.cost(other, lambda).sum(), cost.sum());
    }
  }
  EXPECT_NEAR(equations.usage().sum(), 1.0, kExact);
  EXPECT_NEAR(equations.local_mean()(2, 1), phi.col(2).dot(problem.T.col(1)) / phi.col(2).sum(), kExact);
}

}  // namespace
}  // namespace truebearing::projected_cost_test
