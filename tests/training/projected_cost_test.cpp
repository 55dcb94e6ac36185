// SPDX-License-Identifier: Apache-2.0
#include "training/projected_cost.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "training/rule_passes.hpp"
#include "training/rule_passes_kernel.hpp"
#include "truebearing/core/random.hpp"
#include "truebearing/correction/fuzzy_network.hpp"

namespace truebearing::projected_cost_test {
namespace {

constexpr double kExact = 1e-12;
constexpr double kDerivative = 1e-6;

struct Problem {
  NormalisedRows rows;
  Eigen::MatrixXd centres, widths;
};

Problem random_problem(Eigen::Index rows, Eigen::Index rules) {
  RandomStream random(RunKey{.run = 1}, StreamId::test);
  const auto normal = [&] { return random.normal(); };
  return {{Eigen::MatrixXd::NullaryExpr(3, rows, normal), Eigen::MatrixXd::NullaryExpr(2, rows, normal)},
          Eigen::MatrixXd::NullaryExpr(rules, 3, normal),
          Eigen::MatrixXd::NullaryExpr(rules, 3, [&] { return random.uniform(0.4, 1.5); })};
}

std::vector<Eigen::Index> all_of(const NormalisedRows& rows) {
  std::vector<Eigen::Index> numbers(static_cast<std::size_t>(rows.inputs.cols()));
  std::iota(numbers.begin(), numbers.end(), Eigen::Index{0});
  return numbers;
}

// By the network itself, row by row (n x M).
Eigen::MatrixXd strengths(const Problem& problem) {
  const Eigen::Index M = problem.centres.rows();
  const FuzzyNetwork network({.input_mean = Eigen::VectorXd::Zero(3),
                              .input_scale = Eigen::VectorXd::Ones(3),
                              .input_clip = 100.0,
                              .centres = problem.centres,
                              .widths = problem.widths,
                              .consequents = Eigen::MatrixXd::Zero(M, 2),
                              .output_scale = Eigen::VectorXd::Ones(2)});
  Eigen::MatrixXd phi(problem.rows.inputs.cols(), M);
  FuzzyNetwork::Strengths row;
  for (Eigen::Index n = 0; n < phi.rows(); ++n) {
    network.strengths(problem.rows.inputs.col(n), row);
    phi.row(n) = row.transpose();
  }
  return phi;
}

// More blocks than are worked on at once and a short one; numbers of rules that fill tiles and lanes and that do not.
TEST(RulePasses, SumsAreThoseOfTheNetworksStrengths) {
  for (const Eigen::Index rules : {1, 5, 8, 12}) {
    const Problem problem = random_problem(65 * kernels::kBlockRows + 41, rules);
    const Eigen::MatrixXd phi = strengths(problem), T = problem.rows.targets.transpose();
    RulePasses passes(1);
    const StrengthSums& sums =
        passes.sums(problem.rows, all_of(problem.rows), exponent_coefficients(problem.centres, problem.widths));
    EXPECT_EQ(sums.rows, phi.rows());
    const Eigen::MatrixXd squared = phi.transpose() * phi;
    const double scale = kExact * squared.norm();
    EXPECT_LT((sums.squared - Eigen::MatrixXd(squared.triangularView<Eigen::Lower>())).norm(), scale) << rules;
    EXPECT_LT((sums.by_targets - phi.transpose() * T).norm(), scale) << rules;
    EXPECT_LT((sums.sum - phi.colwise().sum().transpose()).norm(), scale) << rules;
    EXPECT_LT((sums.targets_squared - T.colwise().squaredNorm().transpose()).norm(), kExact * T.squaredNorm());
  }
}

TEST(RulePasses, ThreadsDoNotChangeABit) {
  const Problem problem = random_problem(5 * kernels::kBlockRows + 3, 7);
  const auto gradient = [&](int threads) {
    ProjectedCost projected_cost(Eigen::Vector2d(1.0, 3.0), 0.01, threads);
    ProjectedCost::Gradient found;
    projected_cost.evaluate(problem.rows, all_of(problem.rows), problem.centres, problem.widths, found);
    return found;
  };
  const ProjectedCost::Gradient one = gradient(1), three = gradient(3);
  EXPECT_EQ(one.centres, three.centres);
  EXPECT_EQ(one.log_widths, three.log_widths);
}

// Several blocks, the last one short, and outputs of different weight.
TEST(ProjectedCost, GradientIsThatOfFiniteDifferences) {
  Problem problem = random_problem(2 * kernels::kBlockRows + 57, 6);
  const std::vector<Eigen::Index> rows = all_of(problem.rows);
  const double lambda = 0.01;
  ProjectedCost projected_cost(Eigen::Vector2d(1.0, 3.0), lambda, 1);
  ProjectedCost::Gradient gradient, unused;
  projected_cost.evaluate(problem.rows, rows, problem.centres, problem.widths, gradient);
  const double scale = std::max(gradient.centres.cwiseAbs().maxCoeff(), gradient.log_widths.cwiseAbs().maxCoeff());
  const double step = 1e-5;
  const auto difference = [&](double& parameter, double up, double down) {
    const double kept = parameter;
    parameter = up;
    const double above = projected_cost.evaluate(problem.rows, rows, problem.centres, problem.widths, unused);
    parameter = down;
    const double below = projected_cost.evaluate(problem.rows, rows, problem.centres, problem.widths, unused);
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
  const Eigen::MatrixXd phi = strengths(problem), T = problem.rows.targets.transpose();
  RulePasses passes(1);
  const ConsequentEquations equations(
      passes.sums(problem.rows, all_of(problem.rows), exponent_coefficients(problem.centres, problem.widths)));
  const double lambda = 0.1;
  const Eigen::MatrixXd W = equations.consequents(lambda);
  const Eigen::VectorXd cost = equations.cost(W, lambda);
  const Eigen::RowVectorXd expected =
      (T - phi * W).colwise().squaredNorm() / 200.0 + lambda / 5.0 * W.colwise().squaredNorm();
  EXPECT_LT((cost - expected.transpose()).norm(), kExact);
  for (Eigen::Index k = 0; k < W.size(); ++k) {
    for (const double change : {-0.01, 0.01}) {
      Eigen::MatrixXd other = W;
      other.data()[k] += change;
      EXPECT_GT(equations.cost(other, lambda).sum(), cost.sum());
    }
  }
  EXPECT_NEAR(equations.usage().sum(), 1.0, kExact);
  EXPECT_NEAR(equations.local_mean()(2, 1), phi.col(2).dot(T.col(1)) / phi.col(2).sum(), kExact);
}

}  // namespace
}  // namespace truebearing::projected_cost_test
