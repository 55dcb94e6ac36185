// SPDX-License-Identifier: Apache-2.0
#include "training/back_propagation.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "training/grid_network.hpp"
#include "training/projected_cost.hpp"

namespace truebearing {
namespace {

void validate(const BackPropagationOptions& options) {
  constexpr double kLarge = 1e9;
  require_option("terms_per_input", options.terms_per_input, 2, FuzzyNetwork::kMaxRules);
  require_option("epochs", options.epochs, 0, kLarge);
  require_option("batch_rows", options.batch_rows, 1, kLarge);
  require_option("learning_rate", options.learning_rate, 1e-9, 1.0);
  require_option("momentum", options.momentum, 0.0, 0.999);
  require_option("input_clip", options.input_clip, 0.1, 100.0);
  require_option("width_floor", options.width_floor, 1e-3, 100.0);
}

// A grid over the inputs' range in the training data; an input that does not vary gets a range around its value.
FuzzyPartition data_partition(const Eigen::MatrixXd& U, int terms) {
  const Eigen::VectorXd low = U.colwise().minCoeff();
  const Eigen::VectorXd high = U.colwise().maxCoeff();
  const Eigen::VectorXd margin = (high.array() > low.array()).select(Eigen::VectorXd::Zero(low.size()), 1.0);
  return uniform_partition(low - margin, high + margin, terms);
}

// Gradient descent with momentum: change = momentum change - rate gradient.
void descend(const BackPropagationOptions& options, double rows, const GridParameters& gradient, GridParameters& change,
             GridParameters& parameters) {
  const double rate = options.learning_rate / rows;
  change.centres = options.momentum * change.centres - rate * gradient.centres;
  change.log_widths = options.momentum * change.log_widths - rate * gradient.log_widths;
  change.consequents = options.momentum * change.consequents - rate * gradient.consequents;
  parameters.centres += change.centres;
  parameters.log_widths = (parameters.log_widths + change.log_widths).cwiseMax(std::log(options.width_floor));
  parameters.consequents += change.consequents;
}

void shuffle(std::vector<Eigen::Index>& order, RandomStream& random) {
  for (std::size_t n = order.size(); n > 1; --n) std::swap(order[n - 1], order[random.index(n)]);
}

// One pass over all rows in the given order; the mean cost of the rows as they were met.
double run_epoch(const Eigen::MatrixXd& inputs, const Eigen::MatrixXd& targets, const Eigen::VectorXd& weights,
                 const std::vector<Eigen::Index>& order, const BackPropagationOptions& options, GridParameters& change,
                 GridNetwork& grid) {
  GridParameters gradient;
  double cost = 0.0;
  const std::size_t batch = static_cast<std::size_t>(options.batch_rows);
  for (std::size_t first = 0; first < order.size(); first += batch) {
    const std::size_t last = std::min(first + batch, order.size());
    gradient.set_zero_like(grid.parameters);
    for (std::size_t n = first; n < last; ++n) {
      cost += grid.add_gradient(inputs.col(order[n]), targets.col(order[n]), weights, gradient);
    }
    descend(options, static_cast<double>(last - first), gradient, change, grid.parameters);
  }
  return 2.0 * cost / static_cast<double>(order.size());
}

void describe(const NormalisedRows& rows, const Eigen::VectorXd& weights, TrainedFuzzyNetwork& trained) {
  const FuzzyNetwork::Parameters& parameters = trained.parameters;
  std::vector<Eigen::Index> all(static_cast<std::size_t>(rows.inputs.cols()));
  std::iota(all.begin(), all.end(), Eigen::Index{0});
  const ConsequentEquations equations(
      RulePasses(1).sums(rows, all, exponent_coefficients(parameters.centres, parameters.widths)));
  trained.cost = equations.cost(parameters.consequents, 0.0).dot(weights);
  trained.usage = equations.usage();
  trained.local_mean = equations.local_mean() * parameters.output_scale.asDiagonal();
}

}  // namespace

TrainedFuzzyGrid train_back_propagation(const FuzzyTrainingData& data, const BackPropagationOptions& options,
                                        const TrainingProgress& progress) {
  validate(data, 1);
  validate(options);
  const FuzzyNetwork::Parameters normal = normalisation(data, options.input_clip);
  const NormalisedRows rows = normalised_rows(data, normal);

  const int outputs = static_cast<int>(data.labels.cols());
  GridNetwork grid(data_partition(rows.inputs.transpose(), options.terms_per_input), outputs);
  const Eigen::VectorXd weights = data.weights();
  std::vector<Eigen::Index> order(static_cast<std::size_t>(rows.inputs.cols()));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  RandomStream random = learning_stream(options.seed);
  GridParameters change;
  change.set_zero_like(grid.parameters);
  for (int epoch = 0; epoch < options.epochs; ++epoch) {
    shuffle(order, random);
    const double cost = run_epoch(rows.inputs, rows.targets, weights, order, options, change, grid);
    if (progress) progress(epoch + 1, options.epochs, cost);
  }

  TrainedFuzzyGrid trained{.network = {}, .partition = grid.partition()};
  FuzzyNetwork::Parameters& parameters = trained.network.parameters;
  parameters = expand(trained.partition, outputs);
  parameters.input_mean = normal.input_mean;
  parameters.input_scale = normal.input_scale;
  parameters.input_clip = normal.input_clip;
  parameters.output_scale = normal.output_scale;
  parameters.consequents = grid.parameters.consequents.transpose();
  describe(rows, weights, trained.network);
  return trained;
}

}  // namespace truebearing
