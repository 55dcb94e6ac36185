// SPDX-License-Identifier: Apache-2.0
#include "training/variable_projection.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "training/k_means.hpp"
#include "training/projected_cost.hpp"
#include "training/rule_passes.hpp"
#include "training/rule_passes_kernel.hpp"

namespace truebearing {
namespace {

void validate(const VariableProjectionOptions& options) {
  constexpr double kLarge = 1e9;
  require_option("iterations", options.iterations, 0, kLarge);
  require_option("learning_rate", options.learning_rate, 1e-9, 10.0);
  require_option("ridge", options.ridge, 1e-12, 1e6);
  require_option("input_clip", options.input_clip, 0.1, 100.0);
  require_option("width_floor", options.width_floor, 1e-3, 100.0);
  require_option("max_rows", static_cast<double>(options.max_rows), options.rules, kLarge);
}

// The distance from each centre to its nearest neighbour, the same for all inputs.
Eigen::MatrixXd neighbour_widths(const Eigen::MatrixXd& centres, double floor) {
  Eigen::MatrixXd widths(centres.rows(), centres.cols());
  for (Eigen::Index j = 0; j < centres.rows(); ++j) {
    Eigen::VectorXd distances = (centres.rowwise() - centres.row(j)).rowwise().norm();
    distances[j] = std::numeric_limits<double>::infinity();
    const double nearest = centres.rows() > 1 ? distances.minCoeff() : 1.0;
    widths.row(j).setConstant(std::max(nearest, floor));
  }
  return widths;
}

// Numbers of at most max_rows of `rows`, mirror images included, each with its image.
std::vector<Eigen::Index> draw_rows(const FuzzyTrainingData& data, Eigen::Index max_rows, RandomStream& random) {
  const Eigen::Index wanted = data.mirrored_rows() ? (max_rows + 1) / 2 : max_rows;
  std::vector<Eigen::Index> drawn = stratified_rows(data.rows(), wanted, random);
  if (!data.mirrored_rows()) return drawn;
  const std::size_t count = drawn.size();
  for (std::size_t n = 0; n < count; ++n) drawn.push_back(data.rows() + drawn[n]);
  return drawn;
}

class Adam {
 public:
  explicit Adam(Eigen::Index rows, Eigen::Index cols)
      : mean_(Eigen::ArrayXXd::Zero(rows, cols)), square_(Eigen::ArrayXXd::Zero(rows, cols)) {}

  /// The change of the parameters at step t = 1, 2, ...
  Eigen::MatrixXd step(const Eigen::MatrixXd& gradient, double rate, int t) {
    mean_ = kMeanDecay * mean_ + (1.0 - kMeanDecay) * gradient.array();
    square_ = kSquareDecay * square_ + (1.0 - kSquareDecay) * gradient.array().square();
    const double mean_bias = 1.0 - std::pow(kMeanDecay, t);
    const double square_bias = 1.0 - std::pow(kSquareDecay, t);
    return -rate * (mean_ / mean_bias) / ((square_ / square_bias).sqrt() + kSmall);
  }

 private:
  static constexpr double kMeanDecay = 0.9;
  static constexpr double kSquareDecay = 0.999;
  static constexpr double kSmall = 1e-8;
  Eigen::ArrayXXd mean_;
  Eigen::ArrayXXd square_;
};

Eigen::VectorXd pair_signs(const FuzzyTrainingData& data) {
  return data.paired_rules ? data.output_signs() : Eigen::VectorXd();
}

Eigen::RowVectorXd input_signs(const FuzzyTrainingData& data) {
  return Eigen::Map<const Eigen::RowVectorXi>(data.parity.data(), static_cast<Eigen::Index>(data.parity.size()))
      .cast<double>();
}

// Of rules in mirror pairs, where they begin: the centres of the rows, each taken by whichever of itself and its image
// has the positive sum of odd inputs, and behind them the centres' images.
Eigen::MatrixXd paired_centres(const FuzzyTrainingData& data, Eigen::MatrixXd U, int rules, RandomStream& random) {
  const Eigen::RowVectorXd signs = input_signs(data);
  const Eigen::RowVectorXd odd = (signs.array() < 0.0).cast<double>();
  for (Eigen::Index row = 0; row < U.rows(); ++row)
    if (U.row(row).dot(odd) < 0.0) U.row(row) = U.row(row).cwiseProduct(signs);
  const Eigen::MatrixXd centres = k_means(U, rules / 2, random);
  Eigen::MatrixXd paired(rules, U.cols());
  paired << centres, centres * signs.asDiagonal();
  return paired;
}

// The gradient by the parameters of a pair, which are one, on both of its rules.
void tie(const FuzzyTrainingData& data, ProjectedCost::Gradient& gradient) {
  const Eigen::RowVectorXd signs = input_signs(data);
  const Eigen::Index half = gradient.centres.rows() / 2;
  const Eigen::MatrixXd by_centre =
      gradient.centres.topRows(half) + gradient.centres.bottomRows(half) * signs.asDiagonal();
  const Eigen::MatrixXd by_width = gradient.log_widths.topRows(half) + gradient.log_widths.bottomRows(half);
  gradient.centres << by_centre, by_centre * signs.asDiagonal();
  gradient.log_widths << by_width, by_width;
}

// The same for what is told of the rules.
void tie(const FuzzyTrainingData& data, TrainedFuzzyNetwork& trained) {
  const Eigen::RowVectorXd signs = data.output_signs().transpose();
  const Eigen::Index half = trained.usage.size() / 2;
  for (Eigen::Index j = 0; j < half; ++j) {
    const double sum = trained.usage[j] + trained.usage[half + j];
    const double share = sum > 0.0 ? trained.usage[j] / sum : 0.5;
    trained.local_mean.row(j) =
        share * trained.local_mean.row(j) + (1.0 - share) * trained.local_mean.row(half + j).cwiseProduct(signs);
    trained.local_mean.row(half + j) = trained.local_mean.row(j).cwiseProduct(signs);
    trained.usage[j] = trained.usage[half + j] = 0.5 * sum;
  }
}

// Every iteration draws its rows afresh, so that the loop sees all the data at the price of a sample: the rows of one
// run are alike, and a fixed sample would be learnt by heart.
void descend(const FuzzyTrainingData& data, const NormalisedRows& rows, const VariableProjectionOptions& options,
             RandomStream& random, const TrainingProgress& progress, FuzzyNetwork::Parameters& parameters) {
  ProjectedCost projected_cost(data.weights(), options.ridge, options.threads, pair_signs(data));
  ProjectedCost::Gradient gradient;
  Eigen::MatrixXd log_widths = parameters.widths.array().log();
  Adam centre_steps(log_widths.rows(), log_widths.cols());
  Adam width_steps(log_widths.rows(), log_widths.cols());
  for (int iteration = 1; iteration <= options.iterations; ++iteration) {
    const std::vector<Eigen::Index> sample = draw_rows(data, options.max_rows, random);
    const double cost = projected_cost.evaluate(rows, sample, parameters.centres, parameters.widths, gradient);
    if (progress) progress(iteration, options.iterations, cost);
    if (data.paired_rules) tie(data, gradient);
    const double phase = std::numbers::pi * (iteration - 1) / options.iterations;
    const double rate = 0.5 * options.learning_rate * (1.0 + std::cos(phase));
    parameters.centres += centre_steps.step(gradient.centres, rate, iteration);
    log_widths += width_steps.step(gradient.log_widths, rate, iteration);
    log_widths = log_widths.cwiseMax(std::log(options.width_floor));
    parameters.widths = log_widths.array().exp();
  }
}

// Each block of rows has its mirror images behind it.
std::vector<Eigen::Index> all_rows(const FuzzyTrainingData& data) {
  std::vector<Eigen::Index> rows;
  rows.reserve(static_cast<std::size_t>(2 * data.rows()));
  const Eigen::Index step = kernels::kBlockRows / 2;
  for (Eigen::Index first = 0; first < data.rows(); first += step) {
    const Eigen::Index last = std::min(first + step, data.rows());
    for (Eigen::Index row = first; row < last; ++row) rows.push_back(row);
    if (!data.mirrored_rows()) continue;
    for (Eigen::Index row = first; row < last; ++row) rows.push_back(data.rows() + row);
  }
  return rows;
}

void fit_consequents(const FuzzyTrainingData& data, const NormalisedRows& rows,
                     const VariableProjectionOptions& options, TrainedFuzzyNetwork& trained) {
  FuzzyNetwork::Parameters& parameters = trained.parameters;
  const ConsequentEquations equations(
      RulePasses(options.threads)
          .sums(rows, all_rows(data), exponent_coefficients(parameters.centres, parameters.widths)));
  parameters.consequents = equations.consequents(options.ridge, pair_signs(data));
  trained.cost = equations.cost(parameters.consequents, options.ridge).dot(data.weights());
  trained.usage = equations.usage();
  trained.local_mean = equations.local_mean() * parameters.output_scale.asDiagonal();
  if (data.paired_rules) tie(data, trained);
}

}  // namespace

TrainedFuzzyNetwork train_variable_projection(const FuzzyTrainingData& data, const VariableProjectionOptions& options,
                                              const TrainingProgress& progress) {
  validate(data, options.rules);
  validate(options);
  TrainedFuzzyNetwork trained;
  trained.parameters = normalisation(data, options.input_clip);
  RandomStream random = learning_stream(options.seed);
  const NormalisedRows rows = normalised_rows(data, trained.parameters);
  const Eigen::MatrixXd sample = rows.inputs(Eigen::all, draw_rows(data, options.max_rows, random)).transpose();
  trained.parameters.centres =
      data.paired_rules ? paired_centres(data, sample, options.rules, random) : k_means(sample, options.rules, random);
  trained.parameters.widths = neighbour_widths(trained.parameters.centres, options.width_floor);
  descend(data, rows, options, random, progress, trained.parameters);
  fit_consequents(data, rows, options, trained);
  return trained;
}

}  // namespace truebearing
