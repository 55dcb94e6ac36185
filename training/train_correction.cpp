#include "training/train_correction.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <chrono>
#include <fmt/format.h>
#include <vector>

#include "training/back_propagation.hpp"
#include "training/covariance_inflation.hpp"
#include "training/variable_projection.hpp"

namespace truebearing {
namespace {

FuzzyTrainingData training_data(const TeacherSet& teacher, bool mirror) {
  FuzzyTrainingData data{teacher.X, teacher.Y, {}, {}};
  if (mirror)
    for (const FeatureSpec& feature : teacher.features) data.parity.push_back(mirror_parity(feature.kind));
  return data;
}

TrainedFuzzyNetwork train_network(const FuzzyTrainingData& data, const TrainingSpec& spec, const TrainOptions& options) {
  if (spec.method == TrainingSpec::Method::back_propagation) {
    BackPropagationOptions back_propagation;
    back_propagation.terms_per_input = spec.terms_per_input;
    back_propagation.epochs = spec.epochs;
    back_propagation.learning_rate = spec.learning_rate;
    back_propagation.momentum = spec.momentum;
    back_propagation.seed = options.seed;
    return train_back_propagation(data, back_propagation, options.training_progress).network;
  }
  VariableProjectionOptions variable_projection;
  variable_projection.rules = spec.rules;
  variable_projection.iterations = spec.iterations;
  variable_projection.learning_rate = spec.learning_rate;
  variable_projection.ridge = spec.ridge;
  variable_projection.seed = options.seed;
  return train_variable_projection(data, variable_projection, options.training_progress);
}

double quantile_of(std::vector<double> values, double quantile) {
  const auto rank = static_cast<std::ptrdiff_t>(quantile * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), values.begin() + rank, values.end());
  return values[static_cast<std::size_t>(rank)];
}

// The box of the training data; symmetric in the features that a mirrored target mirrors, where mirror images were taught.
BoxGate box_gate(const FuzzyTrainingData& data, const GateSpec& spec) {
  const Eigen::Index d = data.features.cols();
  BoxGate gate{Eigen::VectorXd(d), Eigen::VectorXd(d), spec.edge_fraction};
  for (Eigen::Index i = 0; i < d; ++i) {
    std::vector<double> values(data.features.col(i).begin(), data.features.col(i).end());
    if (data.mirrored() && data.parity[static_cast<std::size_t>(i)] < 0)
      for (std::size_t row = 0, rows = values.size(); row < rows; ++row) values.push_back(-values[row]);
    gate.low[i] = quantile_of(values, spec.quantile);
    gate.high[i] = quantile_of(std::move(values), 1.0 - spec.quantile);
  }
  return gate;
}

// r = e' P^-1 e / n of the corrected estimate's errors on the teacher set, P that of `covariance_of`.
Eigen::VectorXd normalised_squared_errors(const TeacherSet& teacher, const FuzzyNetwork& network) {
  const Eigen::Index n = teacher.Y.cols();
  Eigen::VectorXd r(teacher.X.rows());
  FuzzyNetwork::Strengths phi;
  for (Eigen::Index row = 0; row < r.size(); ++row) {
    network.strengths(FuzzyNetwork::Inputs(teacher.X.row(row).transpose()), phi);
    const Eigen::VectorXd e = teacher.Y.row(row).transpose() - network.output(phi);
    const Eigen::MatrixXd factor = teacher.covariance_factors.row(row).reshaped(n, n);
    r[row] = factor.triangularView<Eigen::Lower>().solve(e).squaredNorm() / static_cast<double>(n);
  }
  return r;
}

}  // namespace

CorrectionModel train_correction(const Study& study, const std::string& name, const TrainOptions& options, TrainReport* report) {
  const CorrectionSpec& spec = study.tracker(name).correction.value();
  const Ensemble ensemble = study.make_ensemble(spec.members());
  const TeacherSet teacher =
      collect_teacher_set(ensemble, spec, study.scenario(), {options.seed, Role::training, options.threads, options.teacher_progress});
  const FuzzyTrainingData data = training_data(teacher, spec.training.mirror);
  const auto begin = std::chrono::steady_clock::now();
  TrainedFuzzyNetwork trained = train_network(data, spec.training, options);
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin;

  CorrectionModel model;
  model.space = &ensemble.tracker(ensemble.index(spec.base)).space();
  model.base = spec.base;
  model.reference = spec.reference;
  model.covariance_of = spec.covariance_of;
  for (const std::string& member : spec.members()) model.trackers[member] = study.configuration_line(member);
  model.features = spec.features;
  model.network = FuzzyNetwork(std::move(trained.parameters));
  if (spec.gate) model.gate = box_gate(data, *spec.gate);
  model.kappa = spec.kappa;
  model.inflation = covariance_inflation(model.network, teacher.X, normalised_squared_errors(teacher, model.network));
  model.usage = trained.usage;
  model.local_mean = trained.local_mean;
  model.provenance = {{"study", study.name()},
                      {"tracker", name},
                      {"seed", fmt::format("{}", options.seed)},
                      {"training_runs", fmt::format("{}", spec.training.runs)},
                      {"training_rows", fmt::format("{}", teacher.X.rows())}};
  model.validate();
  if (report) *report = {teacher.X.rows(), trained.cost, elapsed.count()};
  return model;
}

}  // namespace truebearing
