// SPDX-License-Identifier: Apache-2.0
#include "training/back_propagation.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "training/grid_network.hpp"
#include "truebearing/core/error.hpp"

namespace truebearing::back_propagation_test {
namespace {

constexpr double kDerivative = 1e-6;

FuzzyTrainingData smooth_data(Eigen::Index rows) {
  RandomStream random(RunKey{.run = 1}, StreamId::test);
  FuzzyTrainingData data;
  data.features = Eigen::MatrixXd::NullaryExpr(rows, 2, [&] { return random.uniform(-2.0, 2.0); });
  data.labels.resize(rows, 2);
  data.labels.col(0) = 500.0 * data.features.col(0).array().sin() + 100.0 * data.features.col(1).array();
  data.labels.col(1) = data.features.col(0).cwiseProduct(data.features.col(1));
  return data;
}

TEST(GridNetwork, GradientIsThatOfFiniteDifferences) {
  RandomStream random(RunKey{.run = 2}, StreamId::test);
  GridNetwork grid(uniform_partition(Eigen::Vector3d(-2, -1, 0), Eigen::Vector3d(2, 1, 3), 3), 2);
  for (double& w : grid.parameters.consequents.reshaped()) w = random.normal();
  const Eigen::Vector3d u(0.7, -0.4, 1.1);
  const Eigen::Vector2d t(1.0, -2.0);
  const Eigen::Vector2d weights(1.0, 3.0);
  GridParameters gradient, unused;
  gradient.set_zero_like(grid.parameters);
  unused = gradient;
  grid.add_gradient(u, t, weights, gradient);
  const auto expect_derivative = [&](double& parameter, double expected) {
    const double step = 1e-5;
    const double kept = parameter;
    parameter = kept + step;
    const double above = grid.add_gradient(u, t, weights, unused);
    parameter = kept - step;
    const double below = grid.add_gradient(u, t, weights, unused);
    parameter = kept;
    EXPECT_NEAR(expected, (above - below) / (2.0 * step), kDerivative * (1.0 + std::abs(expected)));
  };
  for (Eigen::Index k = 0; k < gradient.centres.size(); ++k) {
    expect_derivative(grid.parameters.centres[k], gradient.centres[k]);
    expect_derivative(grid.parameters.log_widths[k], gradient.log_widths[k]);
  }
  for (Eigen::Index k = 0; k < gradient.consequents.size(); ++k) {
    expect_derivative(grid.parameters.consequents.data()[k], gradient.consequents.data()[k]);
  }
}

TEST(GridNetwork, EqualsTheNetworkOfItsPartition) {
  const FuzzyTrainingData data = smooth_data(50);
  const TrainedFuzzyGrid trained = train_back_propagation(data, {.epochs = 3});
  FuzzyNetwork::Parameters expanded = expand(trained.partition, 2);
  EXPECT_EQ(expanded.centres, trained.network.parameters.centres);
  EXPECT_EQ(expanded.widths, trained.network.parameters.widths);

  const FuzzyNetwork network(trained.network.parameters);
  FuzzyNetwork::Strengths phi;
  double cost = 0.0;
  for (Eigen::Index n = 0; n < data.rows(); ++n) {
    network.strengths(data.features.row(n).transpose(), phi);
    const Eigen::VectorXd residual = data.labels.row(n).transpose() - network.output(phi);
    cost += residual.cwiseQuotient(trained.network.parameters.output_scale).squaredNorm() / 50.0;
  }
  EXPECT_NEAR(trained.network.cost, cost, 1e-12);
}

TEST(BackPropagation, LearnsASmoothFunction) {
  const FuzzyTrainingData data = smooth_data(1000);
  const double untrained = train_back_propagation(data, {.epochs = 0}).network.cost;
  EXPECT_NEAR(untrained, 2.0, 1e-12);  // consequents 0: all that there is in both outputs
  EXPECT_LT(train_back_propagation(data, {.epochs = 100, .learning_rate = 0.05}).network.cost, 0.01 * untrained);
  EXPECT_LT(train_back_propagation(data, {.epochs = 100, .batch_rows = 10, .learning_rate = 0.05, .momentum = 0.9})
                .network.cost,
            0.01 * untrained);
}

TEST(BackPropagation, StaysFiniteAtTheHighestRate) {
  const TrainedFuzzyGrid trained = train_back_propagation(smooth_data(500), {.epochs = 50, .learning_rate = 1.0});
  EXPECT_TRUE(std::isfinite(trained.network.cost));
  for (const Eigen::VectorXd& widths : trained.partition.widths) EXPECT_GE(widths.minCoeff(), 0.1 - 1e-12);
}

TEST(BackPropagation, SameSeedSameBits) {
  const FuzzyTrainingData data = smooth_data(300);
  const FuzzyNetwork::Parameters first = train_back_propagation(data, {.epochs = 5}).network.parameters;
  EXPECT_EQ(train_back_propagation(data, {.epochs = 5}).network.parameters, first);
  EXPECT_FALSE(train_back_propagation(data, {.epochs = 5, .seed = 2}).network.parameters == first);
}

TEST(BackPropagation, RefusesAGridThatIsTooLargeAndBadOptions) {
  FuzzyTrainingData data = smooth_data(20);
  EXPECT_THROW(train_back_propagation(data, {.terms_per_input = 17}), InputError);
  EXPECT_THROW(train_back_propagation(data, {.batch_rows = 0}), InputError);
  EXPECT_THROW(train_back_propagation(data, {.learning_rate = 2.0}), InputError);
  EXPECT_THROW(train_back_propagation(data, {.momentum = 1.0}), InputError);
  data.features(3, 1) = std::nan("");
  EXPECT_THROW(train_back_propagation(data, {}), InputError);
}

}  // namespace
}  // namespace truebearing::back_propagation_test
