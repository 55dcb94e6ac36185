// SPDX-License-Identifier: Apache-2.0
#include "truebearing/correction/fuzzy_network.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "truebearing/core/error.hpp"
#include "truebearing/core/random.hpp"

namespace truebearing::fuzzy_network_test {
namespace {

constexpr double kExact = 1e-12;
constexpr int kInputs = 4;
constexpr int kRules = 16;
constexpr int kOutputs = 2;

RandomStream test_stream(std::uint64_t run) {
  return {RunKey{.run = run}, StreamId::test};
}

FuzzyNetwork::Parameters random_parameters(std::uint64_t run) {
  RandomStream random = test_stream(run);
  const auto normal = [&] { return random.normal(); };
  const auto positive = [&] { return random.uniform(0.3, 2.0); };
  return {.input_mean = Eigen::VectorXd::NullaryExpr(kInputs, normal),
          .input_scale = Eigen::VectorXd::NullaryExpr(kInputs, positive),
          .input_clip = 4.0,
          .centres = Eigen::MatrixXd::NullaryExpr(kRules, kInputs, normal),
          .widths = Eigen::MatrixXd::NullaryExpr(kRules, kInputs, positive),
          .consequents = Eigen::MatrixXd::NullaryExpr(kRules, kOutputs, normal),
          .output_scale = Eigen::VectorXd::NullaryExpr(kOutputs, positive)};
}

FuzzyNetwork::Inputs random_input(RandomStream& random, double spread) {
  return FuzzyNetwork::Inputs::NullaryExpr(kInputs, [&] { return spread * random.normal(); });
}

FuzzyNetwork::Outputs evaluate(const FuzzyNetwork& network, const FuzzyNetwork::Inputs& input) {
  FuzzyNetwork::Strengths phi;
  network.strengths(input, phi);
  return network.output(phi);
}

TEST(FuzzyNetwork, IsTheWeightedSumOfThePaper) {
  const FuzzyNetwork::Parameters p = random_parameters(1);
  const FuzzyNetwork network(p);
  RandomStream random = test_stream(2);
  for (int n = 0; n < 100; ++n) {
    const FuzzyNetwork::Inputs input = random_input(random, 1.0);
    Eigen::VectorXd numerator = Eigen::VectorXd::Zero(kOutputs);  // Equation (12)
    double denominator = 0.0;
    for (int j = 0; j < kRules; ++j) {
      double strength = 1.0;
      for (int i = 0; i < kInputs; ++i) {
        const double u = std::clamp((input[i] - p.input_mean[i]) / p.input_scale[i], -p.input_clip, p.input_clip);
        strength *= std::exp(-0.5 * std::pow((u - p.centres(j, i)) / p.widths(j, i), 2));
      }
      numerator += strength * p.consequents.row(j).transpose();
      denominator += strength;
    }
    const Eigen::VectorXd expected = p.output_scale.cwiseProduct(numerator / denominator);
    EXPECT_LT((evaluate(network, input) - expected).norm(), kExact * (1.0 + expected.norm()));
  }
}

// Of any number of rules, whether they fill up a register or not: strengths to the last digits of their exponents, and
// in one go what they weight.
TEST(FuzzyNetwork, AnswersWhatItsStrengthsWeight) {
  RandomStream random = test_stream(31);
  const auto normal = [&] { return random.normal(); };
  for (const int rules : {1, 3, 7, 8, 9, 16, 21, 31, 32, 33, 64, 250, 256}) {
    FuzzyNetwork::Parameters p = random_parameters(32);
    p.centres = 2.0 * Eigen::MatrixXd::NullaryExpr(rules, kInputs, normal);
    p.widths = Eigen::MatrixXd::NullaryExpr(rules, kInputs, [&] { return random.uniform(0.3, 2.0); });
    p.consequents = Eigen::MatrixXd::NullaryExpr(rules, kOutputs, normal);
    Eigen::MatrixXd matrices = Eigen::MatrixXd::NullaryExpr(rules, 9, normal);
    for (const auto& [above, below] : {std::pair{3, 1}, {6, 2}, {7, 5}}) matrices.col(above) = matrices.col(below);
    const FuzzyNetwork network(p);
    for (int n = 0; n < 20; ++n) {
      const FuzzyNetwork::Inputs input = random_input(random, 1.5);
      const Eigen::VectorXd u = (input - p.input_mean).cwiseQuotient(p.input_scale).cwiseMax(-4.0).cwiseMin(4.0);
      Eigen::VectorXd exponent(rules);
      for (int j = 0; j < rules; ++j)
        exponent[j] = -0.5 * (u.transpose() - p.centres.row(j)).cwiseQuotient(p.widths.row(j)).squaredNorm();
      const Eigen::VectorXd strength = (exponent.array() - exponent.maxCoeff()).exp();
      FuzzyNetwork::Strengths phi;
      network.strengths(input, phi);
      for (int j = 0; j < rules; ++j) {
        const double expected = strength[j] / strength.sum();
        EXPECT_NEAR(phi[j], expected, 1e-15 * (10.0 - exponent[j]) * expected + 1e-300) << rules;
      }

      FuzzyNetwork::Outputs y;
      Eigen::Matrix3d mean;
      network.answer(input, y, 3, matrices.data(), mean.data());
      EXPECT_LT((y - network.output(phi)).norm(), 1e-14 * (1.0 + network.output(phi).norm())) << rules;
      const Eigen::Matrix3d weighted = (matrices.transpose() * phi).reshaped(3, 3);
      EXPECT_LT((mean - weighted).norm(), 1e-14 * (1.0 + weighted.norm())) << rules;
    }
  }
}

TEST(FuzzyNetwork, JacobianIsThatOfCentralDifferences) {
  const FuzzyNetwork network(random_parameters(21));
  RandomStream random = test_stream(22);
  constexpr double kStep = 1e-5;
  for (int n = 0; n < 50; ++n) {
    const FuzzyNetwork::Inputs input = random_input(random, 1.0);
    FuzzyNetwork::Strengths phi;
    network.strengths(input, phi);
    const FuzzyNetwork::Jacobian slope = network.jacobian(input, phi);
    ASSERT_EQ(slope.rows(), kOutputs);
    ASSERT_EQ(slope.cols(), kInputs);
    for (int i = 0; i < kInputs; ++i) {
      FuzzyNetwork::Inputs above = input, below = input;
      above[i] += kStep;
      below[i] -= kStep;
      const Eigen::VectorXd expected = (evaluate(network, above) - evaluate(network, below)) / (2.0 * kStep);
      EXPECT_LT((slope.col(i) - expected).norm(), 1e-6 * (1.0 + expected.norm()));
    }
  }
}

TEST(FuzzyNetwork, HasNoSlopeWhereAnInputIsClipped) {
  const FuzzyNetwork::Parameters p = random_parameters(23);
  const FuzzyNetwork network(p);
  FuzzyNetwork::Inputs input = p.input_mean;
  input[1] += 5.0 * p.input_scale[1];
  FuzzyNetwork::Strengths phi;
  network.strengths(input, phi);
  const FuzzyNetwork::Jacobian slope = network.jacobian(input, phi);
  EXPECT_EQ(slope.col(1).norm(), 0.0);
  EXPECT_GT(slope.col(0).norm(), 0.0);
}

TEST(FuzzyNetwork, StrengthsAreNotNegativeAndSumToOne) {
  const FuzzyNetwork network(random_parameters(3));
  RandomStream random = test_stream(4);
  FuzzyNetwork::Strengths phi;
  for (const double spread : {0.1, 1.0, 10.0, 1e6}) {
    network.strengths(random_input(random, spread), phi);
    EXPECT_GE(phi.minCoeff(), 0.0);
    EXPECT_NEAR(phi.sum(), 1.0, kExact);
  }
}

TEST(FuzzyNetwork, OutputStaysInTheHullOfTheConsequents) {
  const FuzzyNetwork::Parameters p = random_parameters(5);
  const FuzzyNetwork network(p);
  RandomStream random = test_stream(6);
  const Eigen::MatrixXd scaled = p.consequents * p.output_scale.asDiagonal();
  for (int n = 0; n < 200; ++n) {
    const FuzzyNetwork::Outputs y = evaluate(network, random_input(random, 0.1 * n));
    for (int o = 0; o < kOutputs; ++o) {
      EXPECT_LE(y[o], scaled.col(o).maxCoeff() + kExact);
      EXPECT_GE(y[o], scaled.col(o).minCoeff() - kExact);
    }
  }
}

TEST(FuzzyNetwork, FarInputsGiveFiniteOutputs) {
  FuzzyNetwork::Parameters p = random_parameters(7);
  p.widths.setConstant(1e-3);
  p.input_clip = 1e6;
  const FuzzyNetwork network(p);
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double far : {1e3, 1e300, infinity, -infinity}) {
    EXPECT_TRUE(evaluate(network, FuzzyNetwork::Inputs::Constant(kInputs, far)).allFinite()) << far;
  }
}

TEST(FuzzyNetwork, InputsBeyondTheClipChangeNothing) {
  const FuzzyNetwork::Parameters p = random_parameters(8);
  const FuzzyNetwork network(p);
  const FuzzyNetwork::Inputs edge = p.input_mean + 4.0 * p.input_scale;
  const FuzzyNetwork::Inputs beyond = p.input_mean + 40.0 * p.input_scale;
  EXPECT_LT((evaluate(network, edge) - evaluate(network, beyond)).norm(), kExact);
}

TEST(FuzzyNetwork, NotANumberIsNotHidden) {
  const FuzzyNetwork network(random_parameters(9));
  for (int i = 0; i < kInputs; ++i) {
    FuzzyNetwork::Inputs input = FuzzyNetwork::Inputs::Zero(kInputs);
    input[i] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_TRUE(evaluate(network, input).array().isNaN().all());
  }
}

TEST(FuzzyNetwork, RuleOrderChangesNothing) {
  const FuzzyNetwork::Parameters p = random_parameters(10);
  FuzzyNetwork::Parameters reversed = p;
  reversed.centres = p.centres.colwise().reverse();
  reversed.widths = p.widths.colwise().reverse();
  reversed.consequents = p.consequents.colwise().reverse();
  const FuzzyNetwork network(p);
  const FuzzyNetwork other(reversed);
  RandomStream random = test_stream(11);
  for (int n = 0; n < 100; ++n) {
    const FuzzyNetwork::Inputs input = random_input(random, 2.0);
    EXPECT_LT((evaluate(network, input) - evaluate(other, input)).norm(), kExact);
  }
}

TEST(FuzzyNetwork, RefusesBadParameters) {
  const FuzzyNetwork::Parameters good = random_parameters(14);
  const auto refuses = [&](auto spoil) {
    FuzzyNetwork::Parameters bad = good;
    spoil(bad);
    EXPECT_THROW(FuzzyNetwork{bad}, InputError);
  };
  using Parameters = FuzzyNetwork::Parameters;
  EXPECT_THROW(FuzzyNetwork{Parameters{}}, InputError);
  refuses([](Parameters& p) { p.input_mean.resize(3); });
  refuses([](Parameters& p) { p.widths = p.widths.leftCols(3).eval(); });
  refuses([](Parameters& p) { p.consequents = p.consequents.topRows(3).eval(); });
  refuses([](Parameters& p) { p.output_scale.resize(0); });
  refuses([](Parameters& p) { p.input_scale[1] = 0.0; });
  refuses([](Parameters& p) { p.widths(2, 1) = -1.0; });
  refuses([](Parameters& p) { p.centres(2, 1) = std::numeric_limits<double>::quiet_NaN(); });
  refuses([](Parameters& p) { p.consequents(0, 0) = std::numeric_limits<double>::infinity(); });
  refuses([](Parameters& p) { p.input_clip = 0.0; });
  refuses([](Parameters& p) { p.widths(0, 0) = 1e-310; });
  refuses([](Parameters& p) {
    p.centres.setZero(FuzzyNetwork::kMaxRules + 1, kInputs);
    p.widths.setOnes(FuzzyNetwork::kMaxRules + 1, kInputs);
    p.consequents.setZero(FuzzyNetwork::kMaxRules + 1, kOutputs);
  });
}

}  // namespace
}  // namespace truebearing::fuzzy_network_test
