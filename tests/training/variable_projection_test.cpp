// SPDX-License-Identifier: Apache-2.0
#include "training/variable_projection.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <thread>

#include "truebearing/core/error.hpp"

namespace truebearing::variable_projection_test {
namespace {

Eigen::MatrixXd evaluate(const FuzzyNetwork::Parameters& parameters, const Eigen::MatrixXd& features) {
  const FuzzyNetwork network(parameters);
  FuzzyNetwork::Strengths phi;
  Eigen::MatrixXd outputs(features.rows(), network.outputs());
  for (Eigen::Index n = 0; n < features.rows(); ++n) {
    network.strengths(features.row(n).transpose(), phi);
    outputs.row(n) = network.output(phi).transpose();
  }
  return outputs;
}

double relative_error(const Eigen::MatrixXd& found, const Eigen::MatrixXd& expected) {
  return (found - expected).norm() / expected.norm();
}

Eigen::MatrixXd uniform_features(Eigen::Index rows, Eigen::Index inputs, std::uint64_t run) {
  RandomStream random(RunKey{.run = run}, StreamId::test);
  return Eigen::MatrixXd::NullaryExpr(rows, inputs, [&] { return random.uniform(-2.0, 2.0); });
}

// Odd in the second feature and even in the first; in different units.
FuzzyTrainingData odd_data(Eigen::Index rows, std::uint64_t run) {
  FuzzyTrainingData data{
      .features = uniform_features(rows, 2, run), .labels = {}, .parity = {1, -1}, .output_weights = {}};
  data.labels.resize(rows, 2);
  const auto x = data.features.array();
  data.labels.col(0) = 1000.0 * x.col(0).cos() * (1.5 * x.col(1)).sin();
  data.labels.col(1) = x.col(1) * (0.3 * x.col(0)).exp();
  return data;
}

VariableProjectionOptions quick() {
  return {.rules = 12, .iterations = 60, .max_rows = 2000};
}

// To 2 %: networks that are alike in their outputs lie in a long flat valley.
TEST(VariableProjection, RecoversAKnownNetwork) {
  const FuzzyNetwork::Parameters teacher{.input_mean = Eigen::Vector2d::Zero(),
                                         .input_scale = Eigen::Vector2d::Ones(),
                                         .input_clip = 4.0,
                                         .centres = Eigen::Matrix<double, 4, 2>{{-1, -1}, {1, -1}, {-1, 1}, {1, 1}},
                                         .widths = Eigen::MatrixXd::Constant(4, 2, 0.8),
                                         .consequents = Eigen::Matrix<double, 4, 2>{{3, 1}, {-1, 2}, {2, -2}, {0, 1}},
                                         .output_scale = Eigen::Vector2d(500.0, 2.0)};
  FuzzyTrainingData data{.features = uniform_features(3000, 2, 1), .labels = {}, .parity = {}, .output_weights = {}};
  data.labels = evaluate(teacher, data.features);
  const TrainedFuzzyNetwork trained =
      train_variable_projection(data, {.rules = 4, .iterations = 300, .ridge = 1e-9, .max_rows = 3000});
  const Eigen::MatrixXd fresh = uniform_features(500, 2, 2);
  EXPECT_LT(relative_error(evaluate(trained.parameters, fresh), evaluate(teacher, fresh)), 0.02);
}

TEST(VariableProjection, IterationsImproveOnKMeansAndTheReportedCostIsTheNetworks) {
  const FuzzyTrainingData data = odd_data(3000, 3);
  VariableProjectionOptions options = quick();
  options.iterations = 0;
  const TrainedFuzzyNetwork start = train_variable_projection(data, options);
  int calls = 0;
  const TrainedFuzzyNetwork trained = train_variable_projection(data, quick(), [&](int iteration, int total, double) {
    EXPECT_EQ(iteration, ++calls);
    EXPECT_EQ(total, 60);
  });
  EXPECT_EQ(calls, 60);
  EXPECT_LT(trained.cost, 0.5 * start.cost);

  // Rows and their mirror images cost the same but for the asymmetry of the network, which is small.
  const FuzzyNetwork::Parameters& p = trained.parameters;
  const Eigen::MatrixXd residuals =
      (data.labels - evaluate(p, data.features)) * p.output_scale.cwiseInverse().asDiagonal();
  const double ridge = 1e-3 / 12.0 * p.consequents.squaredNorm();
  EXPECT_NEAR(trained.cost, residuals.squaredNorm() / 3000.0 + ridge, 0.05 * trained.cost);
}

// By augmentation, so only as exactly as the network fits: within the norm of its own error.
TEST(VariableProjection, MirroredInputsGiveMirroredOutputs) {
  const FuzzyTrainingData data = odd_data(4000, 4);
  const TrainedFuzzyNetwork trained = train_variable_projection(data, quick());
  EXPECT_EQ(trained.parameters.input_mean[1], 0.0);
  Eigen::MatrixXd mirrored = data.features;
  mirrored.col(1) *= -1.0;
  const Eigen::MatrixXd outputs = evaluate(trained.parameters, data.features);
  const Eigen::MatrixXd mirror_sum = outputs + evaluate(trained.parameters, mirrored);
  for (int o = 0; o < 2; ++o) {
    const double error = (outputs - data.labels).col(o).norm();
    EXPECT_LT(mirror_sum.col(o).norm(), 2.0 * error);
    EXPECT_LT(error, 0.1 * data.labels.col(o).norm());
  }
}

// By rules in pairs the symmetry is exact, whatever was learnt, for even outputs as for odd ones.
TEST(VariableProjection, PairedRulesMirrorExactly) {
  FuzzyTrainingData data = odd_data(4000, 4);
  data.labels.col(1) = data.features.col(0).array() + data.features.col(1).array().square();
  data.output_parity = {-1, +1};
  data.paired_rules = true;
  const TrainedFuzzyNetwork trained = train_variable_projection(data, quick());
  Eigen::MatrixXd mirrored = data.features;
  mirrored.col(1) *= -1.0;
  const Eigen::MatrixXd outputs = evaluate(trained.parameters, data.features);
  const Eigen::MatrixXd of_mirrored = evaluate(trained.parameters, mirrored);
  EXPECT_LT((of_mirrored.col(0) + outputs.col(0)).norm(), 1e-9 * outputs.col(0).norm());
  EXPECT_LT((of_mirrored.col(1) - outputs.col(1)).norm(), 1e-9 * outputs.col(1).norm());
  EXPECT_LT(relative_error(outputs, data.labels), 0.1);
  EXPECT_LT((trained.usage.head(6) - trained.usage.tail(6)).norm(), 1e-12);

  VariableProjectionOptions odd_number = quick();
  odd_number.rules = 11;
  EXPECT_THROW(train_variable_projection(data, odd_number), InputError);
}

// Data of one side only: without the mirror the other side would be extrapolation.
TEST(VariableProjection, SymmetryTeachesTheSideThatWasNotSeen) {
  FuzzyTrainingData data = odd_data(3000, 5);
  for (Eigen::Index n = 0; n < data.rows(); ++n) {
    if (data.features(n, 1) > 0.0) continue;
    data.features(n, 1) *= -1.0;
    data.labels.row(n) *= -1.0;
  }
  const FuzzyTrainingData both_sides = odd_data(1000, 6);
  const TrainedFuzzyNetwork symmetric = train_variable_projection(data, quick());
  data.parity.clear();
  const TrainedFuzzyNetwork plain = train_variable_projection(data, quick());
  EXPECT_LT(relative_error(evaluate(symmetric.parameters, both_sides.features), both_sides.labels), 0.1);
  EXPECT_GT(relative_error(evaluate(plain.parameters, both_sides.features), both_sides.labels), 0.3);
}

TEST(VariableProjection, SameSeedSameBitsOnAnyThread) {
  const FuzzyTrainingData data = odd_data(3000, 7);
  VariableProjectionOptions options = quick();
  const TrainedFuzzyNetwork first = train_variable_projection(data, options);
  TrainedFuzzyNetwork second;
  std::thread([&] { second = train_variable_projection(data, options); }).join();
  EXPECT_EQ(first.parameters, second.parameters);
  EXPECT_EQ(first.cost, second.cost);
  options.seed = 2;
  EXPECT_FALSE(train_variable_projection(data, options).parameters == first.parameters);
}

TEST(VariableProjection, ReportsUsageAndLocalMeanOfTheRules) {
  FuzzyTrainingData data = odd_data(2000, 8);
  data.parity.clear();
  const TrainedFuzzyNetwork trained = train_variable_projection(data, quick());
  EXPECT_NEAR(trained.usage.sum(), 1.0, 1e-12);
  const FuzzyNetwork network(trained.parameters);
  FuzzyNetwork::Strengths phi;
  Eigen::VectorXd usage = Eigen::VectorXd::Zero(12);
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(12, 2);
  for (Eigen::Index n = 0; n < data.rows(); ++n) {
    network.strengths(data.features.row(n).transpose(), phi);
    usage += phi / 2000.0;
    sums += phi * data.labels.row(n) / 2000.0;
  }
  EXPECT_LT(relative_error(trained.usage, usage), 1e-10);
  EXPECT_LT(relative_error(trained.local_mean, usage.cwiseInverse().asDiagonal() * sums), 1e-10);
}

TEST(VariableProjection, ConstantAndRepeatedFeaturesAreNoTrouble) {
  FuzzyTrainingData data = odd_data(2000, 9);
  data.features.conservativeResize(Eigen::NoChange, 4);
  data.features.col(2).setConstant(1e6 / 3.0);
  data.features.col(3) = data.features.col(1);
  data.parity = {1, -1, 1, -1};
  data.labels.col(1).setZero();
  const TrainedFuzzyNetwork trained = train_variable_projection(data, quick());
  EXPECT_EQ(trained.parameters.input_scale[2], 1.0);
  EXPECT_EQ(trained.parameters.output_scale[1], 1.0);
  EXPECT_LT(relative_error(evaluate(trained.parameters, data.features), data.labels), 0.2);
}

TEST(VariableProjection, RefusesBadData) {
  const FuzzyTrainingData good = odd_data(100, 10);
  const auto refuses = [&](auto spoil) {
    FuzzyTrainingData data = good;
    VariableProjectionOptions options = quick();
    spoil(data, options);
    EXPECT_THROW(train_variable_projection(data, options), InputError);
  };
  using Data = FuzzyTrainingData;
  using Options = VariableProjectionOptions;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  refuses([&](Data& data, Options&) { data.features(17, 1) = nan; });
  refuses([&](Data& data, Options&) { data.labels(17, 1) = std::numeric_limits<double>::infinity(); });
  refuses([](Data& data, Options&) { data.labels = data.labels.topRows(99).eval(); });
  refuses([](Data& data, Options&) { data.parity = {1}; });
  refuses([](Data& data, Options&) { data.parity = {1, 0}; });
  refuses([](Data& data, Options&) { data.output_weights = Eigen::Vector2d(1.0, -1.0); });
  refuses([](Data& data, Options&) { data = {}; });
  refuses([](Data&, Options& options) { options.rules = 101; });
  refuses([](Data&, Options& options) { options.rules = 0; });
  refuses([](Data&, Options& options) { options.ridge = 0.0; });
  refuses([&](Data&, Options& options) { options.learning_rate = nan; });
  refuses([](Data&, Options& options) { options.max_rows = 5; });
}

}  // namespace
}  // namespace truebearing::variable_projection_test
